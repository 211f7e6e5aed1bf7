// Measures bytes against added entries: what merging view cells, objects or both leaves of a matrix, and what codecs make
// of it.
//
// Matrices over nodes of a tree: the methods of Zach & Karner 2003 after their greedy order of the merged view cells, their Table 3.
// Others: row codecs and whole-file compressors after the best order of both sides. Each coded matrix is read again and compared
// with the source row by row: nothing visible may be missing. Seconds are of one run.
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "bench/lossy_merge.h"
#include "bench/verbs.h"
#include "codecs/rows/bitmap.h"
#include "programs/csv.h"
#include "programs/names.h"
#include "programs/progress.h"

namespace vismat::bench {
namespace {

struct LossyTablesOptions {
  std::vector<std::filesystem::path> files;
  std::filesystem::path csv;
  std::vector<double> lost = {0, .005, .01, .02, .05, .1, .2};
  std::vector<std::string> methods = {"pairs"}, sides = {"cells", "objects", "both"};
  std::vector<std::string> node_codecs = {"zach3-huffman", "zach3-range", "zach4-huffman", "zach4-range",
                                          "rows-small"};
  std::vector<std::string> codecs = {"rows-small", "rows-quick", "rows-fast-ids", "bv", "pair-ans",
                                     "delimiter",  "xz",         "jbig1"};
  double max_per_cell = 1;
  bool append = false, no_lossless = false;
};

constexpr const char* header =
    "matrix,rows,columns,ones,nodes,method,side,lost,max_per_cell,cells,objects,added,lost_share,added_share,"
    "cell_median,cell_95,cell_worst,merge_s,order_s,names_bytes,table_bytes,codec,bytes,average_run\n";

struct Case {
  std::string method = "none", side = "none";
  double lost = 0;
};

void add_lines(const std::string& name, const Dataset& original, const Case& now,
               const LossyTablesOptions& options, const std::vector<Codec>& codecs, std::string& csv) {
  const Merge merge = now.method == "none"
                          ? without_merge(original)
                          : merge_of(original, merge_side(now.side), find_grouping(now.method),
                                     options_of(original.matrix, now.lost, options.max_per_cell));
  const auto [cells, objects] = merge.data.matrix.shape();
  const auto [rows, columns] = original.matrix.shape();
  const double median = merge.lost_at(.5), high = merge.lost_at(.95), worst = merge.lost_at(1);
  std::printf("  %-6s %-8s %6.2f%% %8u %8u %7.3f%% %8.3f%% %7.2f%% %7.2f%% %7.2f%% %8.2f %8.2f %9ju %11ju",
              now.method.c_str(), now.side.c_str(), 100 * now.lost, cells, objects, 100 * merge.loss.lost(),
              100 * merge.loss.added_share(), 100 * median, 100 * high, 100 * worst, merge.merge_s,
              merge.order_s, std::uintmax_t{merge.names_bytes},
              std::uintmax_t{bitmap_size(merge.data.matrix.shape())});
  for (const Codec& codec : codecs) {
    const Code code = code_of(codec, merge, original.matrix);
    std::printf(" %13ju", std::uintmax_t{code.bytes});
    std::fflush(stdout);
    csv += csv_line(name, rows, columns, original.matrix.ones(), original.source.columns_are_nodes,
                    now.method, now.side, now.lost, options.max_per_cell, cells, objects, merge.loss.added,
                    merge.loss.lost(), merge.loss.added_share(), median, high, worst, merge.merge_s,
                    merge.order_s, merge.names_bytes, bitmap_size(merge.data.matrix.shape()), codec.name,
                    code.bytes, code.average_run);
  }
  std::printf("\n");
  std::fflush(stdout);  // before the progress, on stderr
}

void add_matrix(const std::filesystem::path& file, const LossyTablesOptions& options, std::string& csv) {
  const Dataset original = read_matrix(file);
  const std::string name = matrix_name(file);
  const bool nodes = original.source.columns_are_nodes;
  const auto codecs = codecs_here(nodes ? options.node_codecs : options.codecs);
  std::vector<Case> cases;
  if (!options.no_lossless) cases.push_back({});
  for (const std::string& method : options.methods) {
    for (const std::string& side : options.sides) {
      if (nodes && side != "cells") continue;  // merged nodes have no tree
      for (const double lost : options.lost) cases.push_back({method, side, lost});
    }
  }
  std::printf("\n%s: %u cells, %u %s, %.2f %% visible\n", name.c_str(), original.matrix.shape().rows,
              original.matrix.shape().columns, nodes ? "nodes" : "objects", 100 * original.matrix.density());
  std::printf("  %-6s %-8s %7s %8s %8s %8s %9s %8s %8s %8s %8s %8s %9s %11s", "method", "side", "at most",
              "cells", "objects", "lost", "added", "median", "95 %", "worst", "merge s", "order s", "names B",
              "table B");
  for (const Codec& codec : codecs) std::printf(" %11s B", std::string(codec.name).c_str());
  std::printf("\n");
  const auto progress = cli::show_progress(name + ": merges");
  for (std::size_t i = 0; i < cases.size(); ++i) {
    add_lines(name, original, cases[i], options, codecs, csv);
    progress(i + 1, cases.size());
  }
}

void run_lossy_tables(const LossyTablesOptions& options) {
  std::string csv = table_begin(options.csv, header, options.append);
  for (const auto& file : options.files) {
    add_matrix(file, options, csv);
    write_table(options.csv, csv);
  }
}

}  // namespace

void add_lossy_tables(const Verb& verb) {
  const auto o = std::make_shared<LossyTablesOptions>();
  verb.input("MATRIX", o->files, "Matrix files").required();
  verb.output("--csv", o->csv, Written::text, "File for the tables as CSV");
  verb.flag("--append", o->append, "Add to that file instead of replacing it");
  verb.option("--lost", o->lost, "Shares of the occlusions that merging may lose")
      .comma_separated()
      .between(0., 1.);
  verb.option("--methods", o->methods, "Methods of merging: pairs (ours), seeds (of the paper)")
      .comma_separated();
  verb.option("--sides", o->sides, "Which sides are merged; columns that are nodes never are")
      .comma_separated()
      .one_of({"cells", "objects", "both"});
  verb.option("--node-codecs", o->node_codecs, "Codecs for matrices whose columns are nodes")
      .comma_separated();
  verb.option("--codecs", o->codecs, "Codecs for matrices whose columns are objects").comma_separated();
  verb.option("--max-per-cell", o->max_per_cell, "Share of its own occlusions that one view cell may lose")
      .between(0., 1.);
  verb.flag("--no-lossless", o->no_lossless, "Leave out the lines of the source without loss");
  verb.example("bench lossy-tables koth1.bsp.h5 --lost 0,0.05 --csv curves.csv");
  verb.runs([o] { run_lossy_tables(*o); });
}

}  // namespace vismat::bench
