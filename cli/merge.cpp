// merge: view cells or objects with similar rows or columns in groups, whose unions stand for them; and back.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "cli/summary.h"
#include "cli/verbs.h"
#include "codecs/vmat/sections.h"
#include "layout/groups/grouping.h"
#include "matrix/files/dataset_file.h"
#include "matrix/loss.h"
#include "programs/progress.h"

namespace vismat::cli {
namespace {

struct Options {
  std::filesystem::path in, out;
  std::string side = "cells", method = "pairs";
  double lost = 0.05, max_per_cell = 1;
  std::optional<double> added;
  std::uint64_t seed = 1;
  unsigned threads = 0;
  bool expand = false;
};

void merge(const Options& options) {
  const Grouping& grouping = find_grouping(options.method);
  if (options.out.extension() == ".mtx") {
    throw std::invalid_argument(options.out.string() +
                                ": Matrix Market has no place for the map; write .bsp.h5");
  }
  Dataset data = read_dataset(options.in);
  if (!data.source.boundaries.empty()) {
    throw std::invalid_argument(
        options.in.string() +
        ": holds differences; merge the cells, which 'vismat deltas --undo' makes of them");
  }
  const VisibilityMatrix original = data.matrix;
  const auto [rows, columns] = original.shape();
  const std::uint64_t hidden = std::uint64_t{rows} * columns - original.ones();
  const double budget = options.added ? *options.added * static_cast<double>(original.ones())
                                      : options.lost * static_cast<double>(hidden);
  const MergeSide side = options.side == "cells"     ? MergeSide::rows
                         : options.side == "objects" ? MergeSide::columns
                                                     : MergeSide::both;
  const MergeGroups groups = group_sides(original, side, grouping,
                                         {.lost = static_cast<std::uint64_t>(budget),
                                          .lost_in_row = options.max_per_cell,
                                          .seed = options.seed,
                                          .threads = options.threads,
                                          .progress = show_progress("merging")});
  const bool nodes = data.source.columns_are_nodes;
  data = merged(std::move(data), groups.rows, groups.columns);
  if (!data.provenance.empty()) data.provenance += "; ";
  data.provenance += options.side + " merged by " + options.method +
                     formatted(options.added ? ", %g added at most" : ", %g lost at most",
                               options.added ? *options.added : options.lost);
  if (options.max_per_cell < 1) data.provenance += formatted(", %g of any cell", options.max_per_cell);
  if (options.method == "seeds") data.provenance += ", seed " + std::to_string(options.seed);
  write_dataset(options.out, data);

  if (groups.rows) line("view cells", grouped(groups.rows->groups()) + " of " + grouped(rows) + " are left");
  if (groups.columns)
    line("objects", grouped(groups.columns->groups()) + " of " + grouped(columns) + " are left");
  VisibilityMatrix expanded = groups.rows ? expand_rows(data.matrix, *groups.rows) : data.matrix;
  if (groups.columns) expanded = expand_columns(expanded, *groups.columns);
  print_loss(loss_of(expanded, original));
  line("map", grouped(group_size(groups.rows) + group_size(groups.columns)) + " bytes in a .vmat file");
  if (nodes && !data.source.columns_are_nodes) line("tree", "left out: its nodes were merged");
}

void expand(const Options& options) {
  Dataset data = read_dataset(options.in);
  if (!data.source.row_groups && !data.source.column_groups)
    throw std::invalid_argument(options.in.string() + ": nothing in it was merged");
  write_dataset(options.out, in_source_numbers(std::move(data)));
}

}  // namespace

void add_merge(CLI::App& app) {
  const auto options = std::make_shared<Options>();
  CLI::App* verb =
      app.add_subcommand("merge", "Merge similar view cells or objects; what is visible stays so");
  std::string methods;
  for (const Grouping& grouping : groupings()) {
    methods += (methods.empty() ? "" : "; ") + std::string(grouping.name) + ": " + std::string(grouping.idea);
  }
  verb->add_option("MATRIX", options->in, "Matrix file, .bsp.h5 or .mtx")->required();
  verb->add_option("-o,--output", options->out,
                   "Matrix file to write, .bsp.h5: the groups' unions and the map")
      ->required();
  CLI::Option* lost =
      verb->add_option("--lost", options->lost, "Most occlusions (zeros) that may be lost, as a share")
          ->check(CLI::Range(0.0, 1.0))
          ->capture_default_str();
  verb->add_option("--added", options->added, "The same bound as a share of what is visible: ones added")
      ->check(CLI::NonNegativeNumber)
      ->excludes(lost);
  verb->add_option("--max-per-cell", options->max_per_cell,
                   "Most of its own occlusions that any one view cell may lose, as a share")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  verb->add_option("--side", options->side, "What is merged")
      ->check(CLI::IsMember({"cells", "objects", "both"}))
      ->capture_default_str();
  verb->add_option("--method", options->method, "Which to merge; " + methods)->capture_default_str();
  verb->add_option("--seed", options->seed, "For seeds")->capture_default_str();
  verb->add_option("--threads", options->threads, "0: one a core")->capture_default_str();
  verb->add_flag("--expand", options->expand,
                 "From groups to all view cells and objects, as their groups see");
  verb->footer(
      "Example: vismat merge city.bsp.h5 --lost 0.05 -o merged.bsp.h5\n"
      "         vismat verify merged.bsp.h5 city.bsp.h5");
  verb->callback([options] { options->expand ? expand(*options) : merge(*options); });
}

}  // namespace vismat::cli
