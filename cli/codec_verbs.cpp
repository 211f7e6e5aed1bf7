// encode, decode, row, node: matrix files to .vmat and back; one row or one node of a .vmat alone.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "cli/progress.h"
#include "cli/verbs.h"
#include "cli/vmat_files.h"
#include "codecs/baseline_codecs.h"
#include "codecs/bitmap.h"
#include "codecs/container.h"
#include "codecs/pairs.h"
#include "codecs/panne.h"
#include "codecs/row_reader.h"
#include "codecs/sections.h"
#include "codecs/tree_coding.h"
#include "layout/greedy_order.h"
#include "matrix/atomic_file.h"
#include "matrix/dataset.h"
#include "visibility/bounding_volume_tree.h"

namespace vismat::cli {
namespace {

std::string codec_names() {
  std::string names;
  for (const Codec& codec : all_codecs()) names += (names.empty() ? "" : ", ") + std::string(codec.name);
  return names;
}

NodeReader open_nodes(const Container& container) {
  const ObjectTree* const tree = tree_for(find_codec(container.codec), container);
  if (tree == nullptr) throw FormatError("no tree; the codec '" + container.codec + "' needs one");
  return {container.codec, container.encoded.payload, container.encoded.index, container.shape, *tree};
}

}  // namespace

void add_encode(CLI::App& app) {
  struct Options {
    std::filesystem::path in, out;
    std::string codec = "delimiter", order = "greedy";
    double seconds = 0;
  };
  auto options = std::make_shared<Options>();
  CLI::App* verb = app.add_subcommand("encode", "Compress a matrix into a .vmat file");
  verb->add_option("MATRIX", options->in, "Matrix file, .bsp.h5 or .mtx")->required();
  verb->add_option("-o,--output", options->out, "The .vmat file to write")->required();
  verb->add_option("--codec", options->codec, "One of " + codec_names())->capture_default_str();
  verb->add_option("--rows", options->order,
                   "Rows for zach3 and zach4: greedy order, or natural (as they stand)")
      ->check(CLI::IsMember({"greedy", "natural"}))
      ->capture_default_str();
  verb->add_option("--seconds", options->seconds,
                   "For panne: search for clusters as long as this; what comes of it depends on the machine. 0: until little "
                   "is found, the same on any")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  verb->footer("Example: vismat encode city32.bsp.h5 --codec zach3-range -o city32.vmat");
  verb->callback([options] {
    const Codec& codec = find_codec(options->codec);
    const bool panne = codec.name == "panne";
    if (options->seconds > 0 && !panne)
      throw std::invalid_argument("--seconds is for the search of codec panne; '" + options->codec + "' has none");
    Dataset data = read_dataset(options->in);
    if (codec.over_tree == TreeOver::columns && data.source.tree && !data.source.columns_are_nodes) data = over_nodes(data);
    if (codec.over_tree == TreeOver::rows && !data.source.row_tree) {
      if (data.row_bounds.empty()) {
        throw std::invalid_argument(options->in.string() +
                                    ": has no tree over its rows and no boxes to make one from; see 'vismat tree "
                                    "--side rows --by sets'");
      }
      data.source.row_tree = bounding_volume_tree(data.row_bounds, 2);
    }
    if (codec.wants_row_order && options->order == "greedy") {
      const Permutation order = order_rows_greedily(data.matrix, show_progress("ordering rows"));
      data = reordered(std::move(data), order, Permutation::identity(data.matrix.shape().columns));
    }
    Container container =
        panne ? container_of(data.matrix, codec,
                             encode_panne(data.matrix, {.seconds = options->seconds,
                                                        .progress = show_progress("searching for clusters")}))
              : compress(data.matrix, codec, tree_for(codec, data.source));
    container.tree = data.source.tree;
    container.row_tree = data.source.row_tree;
    container.row_order = data.source.row_order;
    container.column_order = data.source.column_order;
    container.row_groups = data.source.row_groups;
    container.column_groups = data.source.column_groups;
    container.boundaries = data.source.boundaries;
    container.facts = facts_of(data);
    write_file(options->out, write_container(container));
    const std::size_t payload = container.encoded.payload.size(), index = container.encoded.index.size();
    const auto [rows, columns] = data.matrix.shape();
    std::printf("%s: %zu bytes of payload, %.2fx smaller than the bitmap's %llu", options->out.c_str(),
                payload, static_cast<double>(bitmap_size({rows, columns})) / static_cast<double>(payload),
                static_cast<unsigned long long>(bitmap_size({rows, columns})));
    if (index > 0) std::printf("; index %zu bytes", index);
    const std::uint64_t orders =
        (data.source.row_order ? permutation_bytes(rows) : 0) + (data.source.column_order ? permutation_bytes(columns) : 0);
    if (orders > 0) std::printf("; orders %llu bytes", static_cast<unsigned long long>(orders));
    const std::size_t groups = group_bytes(data.source.row_groups).size() + group_bytes(data.source.column_groups).size();
    if (groups > 0) std::printf("; groups %zu bytes", groups);
    std::printf("\n");
  });
}

void add_decode(CLI::App& app) {
  struct Options {
    std::filesystem::path in, out;
    bool as_stored = false;
  };
  auto options = std::make_shared<Options>();
  CLI::App* verb = app.add_subcommand("decode", "Restore the matrix of a .vmat file, in the source's order");
  verb->add_option("FILE", options->in, "The .vmat file")->required();
  verb->add_option("-o,--output", options->out, "Matrix file to write, .bsp.h5 or .mtx")->required();
  verb->add_flag("--as-stored", options->as_stored,
                 "Leave rows and columns in the order that they were given");
  verb->footer("Example: vismat decode city32.vmat -o city32.mtx");
  verb->callback([options] {
    Dataset data = read_vmat(options->in);
    if (!options->as_stored) data = in_source_order(std::move(data));
    write_dataset(options->out, data);
    std::printf("%s: %u x %u, %llu ones\n", options->out.c_str(), data.matrix.shape().rows,
                data.matrix.shape().columns, static_cast<unsigned long long>(data.matrix.ones()));
  });
}

namespace {

// Rows of a file of either kind: where each can be read alone, and where they are the leafs of a tree.
struct StoredRows {
  Shape shape;
  std::optional<Permutation> row_order, column_order;
  std::optional<Partition> row_groups, column_groups;
  std::function<std::vector<std::uint32_t>(std::uint32_t row)> ids;
  std::function<std::string(std::uint32_t row)> cost;
};

void with_rows(const std::filesystem::path& path, const std::function<void(const StoredRows&)>& work) {
  const auto codecs = all_codecs();
  const std::string name = codec_of(path);
  if (std::none_of(codecs.begin(), codecs.end(),
                   [&](const Codec& c) { return c.name == name && c.over_tree == TreeOver::rows; })) {
    const RowReader reader(path, codecs);
    RowBuffer<std::uint32_t> buffer;
    work({reader.shape(), reader.row_order(), reader.column_order(), reader.row_groups(), reader.column_groups(),
          [&](std::uint32_t row) {
            const auto ids = reader.ids(row, buffer);
            return std::vector<std::uint32_t>(ids.begin(), ids.end());
          },
          [&](std::uint32_t row) { return std::to_string(reader.row_bytes(row)) + " bytes"; }});
    return;
  }
  with_container(path, [&](const Container& container) {
    const NodeReader reader = open_nodes(container);
    work({container.shape, container.row_order, container.column_order, container.row_groups, container.column_groups,
          [&](std::uint32_t row) { return reader.set(reader.node_of_row(row)).members; },
          [&](std::uint32_t row) {
            const NodeReader::Cost cost = reader.cost(reader.node_of_row(row));
            return std::to_string(cost.bytes) + " bytes of " + std::to_string(cost.parts) + " parts";
          }});
  });
}

}  // namespace

void add_row(CLI::App& app) {
  struct Options {
    std::filesystem::path in;
    std::uint32_t row = 0;
    bool as_stored = false, runs = false;
  };
  auto options = std::make_shared<Options>();
  CLI::App* verb = app.add_subcommand("row", "Decode one row of a .vmat file, without the rest");
  verb->add_option("FILE", options->in, "A .vmat file of a codec that gives rows alone")->required();
  verb->add_option("ROW", options->row, "Row number, 0 is the first")->required();
  verb->add_flag("--as-stored", options->as_stored,
                 "Numbers of rows and columns are the file's, not the source's");
  verb->add_flag("--runs", options->runs,
                 "A line for each run of ids, first and last, instead of one for each id");
  verb->footer("Example: vismat row city32.vmat 17");
  verb->callback([options] {
    with_rows(options->in, [&](const StoredRows& stored) {
      auto [shape, row_order, column_order, row_groups, column_groups, ids_of, cost_of] = stored;
      if (options->as_stored) {
        row_order = column_order = std::nullopt;
        row_groups = column_groups = std::nullopt;
      }
      std::uint32_t row = options->row;
      if (const std::uint32_t rows = row_groups ? row_groups->size() : shape.rows; row >= rows) {
        throw std::invalid_argument(options->in.string() + ": no row " + std::to_string(row) + "; it has " +
                                    std::to_string(rows));
      }
      if (row_order) row = row_order->new_of_old()[row];
      if (row_groups) row = row_groups->group_of_member()[row];
      std::vector<std::uint32_t> ids = ids_of(row);
      if (column_order) {
        const auto source_of = column_order->old_of_new();
        for (std::uint32_t& id : ids) id = source_of[id];
      }
      if (column_groups) {
        const VisibilityMatrix members = column_groups->members();
        for (const std::uint32_t id : std::exchange(ids, {}))
          ids.insert(ids.end(), members.row(id).begin(), members.row(id).end());
      }
      std::sort(ids.begin(), ids.end());
      if (options->runs) {
        for_each_run(ids, [](std::uint32_t first, std::uint32_t count) {
          std::printf("%u %u\n", first, first + count - 1);
        });
      } else {
        for (const std::uint32_t id : ids) std::printf("%u\n", id);
      }
      std::fprintf(stderr, "row %u: %zu of %u visible, %s\n", options->row, ids.size(),
                   column_groups ? column_groups->size() : shape.columns, cost_of(row).c_str());
    });
  });
}

void add_node(CLI::App& app) {
  struct Options {
    std::filesystem::path in;
    std::uint32_t node = 0;
    bool ids = false;
  };
  auto options = std::make_shared<Options>();
  CLI::App* verb =
      app.add_subcommand("node", "Decode one tree node's children from a .vmat file, without the rest");
  verb->add_option("FILE", options->in, "A .vmat file of a codec over a tree")->required();
  verb->add_option("NODE", options->node, "Node number, 0 is the root")->required();
  verb->add_flag("--ids", options->ids, "Also the numbers in the node's own set, as the file has them");
  verb->footer(
      "Over a tree of columns (zach...) a node's set is the view cells that see it, over one of rows (gotsman...) the "
      "objects that are seen from below it.\n"
      "Example: vismat node city32.vmat 0");
  verb->callback([options] {
    with_container(options->in, [&](const Container& container) {
      const Codec& codec = find_codec(container.codec);
      const bool over_rows = codec.over_tree == TreeOver::rows;
      const ObjectTree* const tree = tree_for(codec, container);
      if (tree == nullptr || options->node >= tree->size()) {
        throw std::invalid_argument(options->in.string() + ": no node " + std::to_string(options->node) +
                                    "; it has " + std::to_string(tree ? tree->size() : 0));
      }
      const NodeReader reader = open_nodes(container);
      const NodeSet set = reader.set(options->node);
      const auto children = reader.children(set);
      const char* const of = over_rows ? "sees" : "visible from";
      const char* const what = over_rows ? "objects" : "view cells";
      std::printf("node %u: %s %zu of %u %s; %zu children in %llu bytes\n", options->node, of, set.members.size(),
                  over_rows ? container.shape.columns : container.shape.rows, what, children.size(),
                  static_cast<unsigned long long>(reader.part_bytes(options->node)));
      for (const NodeSet& child : children)
        std::printf("  child %8u: %s %8zu %s\n", child.node, of, child.members.size(), what);
      if (options->ids) {
        for (const std::uint32_t id : set.members) std::printf("%u\n", id);
      }
    });
  });
}

}  // namespace vismat::cli
