// Measures Gotsman's methods over trees of view cells, and ours under contexts, beside codecs that know no tree: bytes, and what a
// row costs that is read alone. Every codec is checked by a round trip and every row of it against the matrix before it is timed.
//
// Writes a line for each matrix, order of columns, tree and codec. Trees are made by the boxes of the view cells ("k-d") or by
// similar sets ("by sets"). A row is read by walking down from the root. row_path_us is the median of reading all rows in the order
// of the tree, where the part of the way that a row shares with the one before is not walked again.
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "bench/verbs.h"
#include "codecs/baselines/baseline_codecs.h"
#include "codecs/baselines/program_codecs.h"
#include "codecs/rows/bitmap.h"
#include "codecs/tree/tree_coding.h"
#include "codecs/vmat/container.h"
#include "codecs/vmat/row_reader.h"
#include "codecs/vmat/sections.h"
#include "layout/best_order.h"
#include "layout/orders/random_order.h"
#include "layout/trees/set_tree.h"
#include "matrix/files/dataset_file.h"
#include "programs/csv.h"
#include "programs/measuring.h"
#include "programs/names.h"
#include "visibility/geometry/bounding_volume_tree.h"

namespace vismat::bench {
namespace {

struct GotsmanTablesOptions {
  std::filesystem::path csv;
  std::vector<std::filesystem::path> files;
  std::vector<std::string> orders = {"natural", "best"};
  double seconds = .2;
};

struct RowCost {
  double median_us = 0, high_us = 0, path_us = 0, bytes = 0, parts = 0;
};

struct Line {
  std::size_t payload = 0, model = 0, index = 0, tree = 0;
  double encode_s = 0, decode_s = 0;
  std::optional<RowCost> row;
};

void check(bool right, const Codec& codec) {
  if (!right) throw std::logic_error(std::string(codec.name) + " does not restore its matrix");
}

RowCost rows_over_tree(const Codec& codec, const Container& container, const VisibilityMatrix& matrix) {
  const ObjectTree& tree = *container.source.row_tree;
  const NodeReader reader(codec, Parts(container.encoded), matrix.shape(), tree);
  const std::uint32_t rows = matrix.shape().rows;
  RowCost cost;
  std::vector<double> alone, on_path;
  const auto shuffled = random_order(rows, 1).old_of_new();
  for (std::uint32_t i = 0; i < std::min(rows, 2000u); ++i) {
    const std::uint32_t node = reader.node_of_row(shuffled[i]);
    NodeSet set;
    alone.push_back(1e6 * seconds_of([&] { set = reader.set(node); }));
    check(std::ranges::equal(set.members, matrix.row(shuffled[i])), codec);
    const RowSource::Cost read = reader.cost(node);
    cost.bytes += static_cast<double>(read.bytes) / std::min(rows, 2000u);
    cost.parts += static_cast<double>(read.parts) / std::min(rows, 2000u);
  }
  // As the leafs lie in the tree, from left to right.
  std::vector<std::uint32_t> waiting = {0}, leafs;
  while (!waiting.empty()) {
    const std::uint32_t node = waiting.back();
    waiting.pop_back();
    const auto children = tree.children(node);
    if (children.empty()) leafs.push_back(node);
    waiting.insert(waiting.end(), children.rbegin(), children.rend());
  }
  NodePath path;
  for (const std::uint32_t leaf : leafs) {
    on_path.push_back(1e6 * seconds_of([&] { reader.set(leaf, path); }));
    check(std::ranges::equal(path.last().members, matrix.row(tree.object_of_node()[leaf])), codec);
  }
  cost.median_us = median(alone);
  cost.high_us = quantile(alone, .95);
  cost.path_us = median(on_path);
  return cost;
}

RowCost rows_alone(const Codec& codec, const Container& container, const VisibilityMatrix& matrix) {
  const auto file = write_container(container);
  const RowReader reader(file, std::span(&codec, 1));
  const std::uint32_t rows = matrix.shape().rows;
  RowCost cost;
  std::vector<double> alone;
  RowBuffer<std::uint32_t> buffer;
  for (const std::uint32_t row : random_order(rows, 1).old_of_new()) {
    std::span<const std::uint32_t> ids;
    alone.push_back(1e6 * seconds_of([&] { ids = reader.ids(row, buffer); }));
    check(std::ranges::equal(ids, matrix.row(row)), codec);
    cost.bytes += static_cast<double>(reader.cost(row).bytes) / rows;
  }
  cost.median_us = cost.path_us = median(alone);
  cost.high_us = quantile(alone, .95);
  cost.parts = 1;
  return cost;
}

Line measure(const Codec& codec, const VisibilityMatrix& matrix, const std::optional<ObjectTree>& tree,
             double seconds) {
  SourceMap source;
  source.row_tree = tree;
  const Side side{tree_for(codec, source), {}, {}};
  Container container = compress(matrix, codec, source);
  check(decompress(container, codec) == matrix, codec);
  Line line;
  line.payload = container.encoded.payload.size();
  line.index = container.encoded.index.size();
  line.tree = tree ? tree_bytes(*tree, false).size() : 0;
  line.encode_s = time_passes({seconds}, [&] { codec.encode(matrix, side, {}); }).median;
  line.decode_s = time_passes({seconds}, [&] { decompress(container, codec); }).median;
  if (matrix.shape().rows == 0) return line;
  if (codec.needs.tree == TreeOver::rows) {
    line.model = NodeReader(codec, Parts(container.encoded), matrix.shape(), *tree).model_bytes();
    line.row = rows_over_tree(codec, container, matrix);
  } else if (codec.open != nullptr) {
    line.row = rows_alone(codec, container, matrix);
  }
  return line;
}

void add_lines(const Dataset& data, const std::string& name, const std::string& order, double seconds,
               std::string& csv) {
  const VisibilityMatrix& matrix = data.matrix;
  const Shape shape = matrix.shape();
  std::printf("\n%s, columns %s: %u cells, %u objects, bitmap %ju bytes\n", name.c_str(), order.c_str(),
              shape.rows, shape.columns, std::uintmax_t{bitmap_size(shape)});
  std::printf("  %-8s %-17s %10s %8s %8s %8s %8s %8s %8s %9s %9s %9s %9s %6s\n", "tree", "codec", "payload",
              "ratio", "model", "index", "tree", "enc. ms", "dec. ms", "row us", "95 %", "on path",
              "row bytes", "parts");
  const auto add = [&](const std::string& tree_name, const Codec& codec,
                       const std::optional<ObjectTree>& tree) {
    const Line line = measure(codec, matrix, tree, seconds);
    const RowCost row = line.row.value_or(RowCost{});
    std::printf(
        "  %-8s %-17s %10zu %7.2fx %8zu %8zu %8zu %8.1f %8.1f", tree_name.c_str(),
        std::string(codec.name).c_str(), line.payload,
        static_cast<double>(bitmap_size(shape)) / static_cast<double>(std::max<std::size_t>(line.payload, 1)),
        line.model, line.index, line.tree, 1e3 * line.encode_s, 1e3 * line.decode_s);
    if (line.row)
      std::printf(" %9.2f %9.2f %9.2f %9.0f %6.1f", row.median_us, row.high_us, row.path_us, row.bytes,
                  row.parts);
    std::printf("\n");
    std::fflush(stdout);
    csv += csv_values(name, shape.rows, shape.columns, matrix.ones(), order, tree_name, codec.name,
                      line.payload, line.model, line.index, line.tree, line.encode_s, line.decode_s);
    csv +=
        line.row ? "," + csv_line(row.median_us, row.high_us, row.path_us, row.bytes, row.parts) : ",,,,,\n";
  };
  for (const char* codec : {"pair-ans", "gzip", "xz"}) add("", find_codec(codec), {});
  if (const auto programs = available_program_codecs(); const Codec* zpaq = codec_named("zpaq", programs))
    add("", *zpaq, {});
  const auto add_tree = [&](const char* tree_name, const ObjectTree& tree) {
    for (const Codec& codec : own_codecs()) {
      if (codec.needs.tree == TreeOver::rows) add(tree_name, codec, tree);
    }
  };
  if (!data.row_bounds.empty()) add_tree("k-d", bounding_volume_tree(data.row_bounds, 2));
  add_tree("by sets", tree_by_sets(matrix));
}

void run_gotsman_tables(const GotsmanTablesOptions& options) {
  std::string csv =
      "matrix,rows,columns,ones,order,tree,codec,payload_bytes,model_bytes,index_bytes,tree_bytes,encode_s,"
      "decode_s,row_us,row_us_95,row_path_us,row_bytes_read,row_parts_read\n";
  for (const auto& file : options.files) {
    const Dataset natural = read_dataset(file);
    for (const std::string& order : options.orders) {
      const Dataset data = order == "natural"
                               ? natural
                               : reordered(natural, Permutation::identity(natural.matrix.shape().rows),
                                           best_order(natural.matrix));
      add_lines(data, matrix_name(file), order, options.seconds, csv);
    }
  }
  write_table(options.csv, csv);
}

}  // namespace

void add_gotsman_tables(const Verb& verb) {
  const auto o = std::make_shared<GotsmanTablesOptions>();
  verb.output("--csv", o->csv, Written::text, "File for the table as CSV");
  verb.option("--orders", o->orders, "Orders of the columns").comma_separated().one_of({"natural", "best"});
  verb.option("--seconds", o->seconds,
              "Seconds for each measurement: passes are repeated until this time is over, and the median "
              "time of a pass is reported")
      .between(0, 1e7);
  verb.input("MATRIX", o->files, "Matrix files").required();
  verb.example("bench gotsman-tables koth1.bsp.h5 --orders best --csv gotsman.csv");
  verb.runs([o] { run_gotsman_tables(*o); });
}

}  // namespace vismat::bench
