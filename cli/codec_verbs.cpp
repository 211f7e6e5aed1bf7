// encode, decode, row, node: matrix files to .vmat and back; one row or one node of a .vmat alone.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <initializer_list>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "cli/verbs.h"
#include "cli/vmat_files.h"
#include "codecs/baselines/baseline_codecs.h"
#include "codecs/rows/bitmap.h"
#include "codecs/rows/pairs.h"
#include "codecs/tree/tree_coding.h"
#include "codecs/vmat/container.h"
#include "codecs/vmat/row_reader.h"
#include "matrix/base/atomic_file.h"
#include "matrix/files/dataset_file.h"
#include "programs/prepared_for.h"
#include "programs/progress.h"

namespace vismat::cli {
namespace {

std::string codec_names() {
  std::string names;
  for (const Codec& codec : all_codecs()) names += (names.empty() ? "" : ", ") + std::string(codec.name);
  return names;
}

}  // namespace

void add_encode(CLI::App& app) {
  struct Options {
    std::filesystem::path in, out;
    std::string codec = "delimiter", order = "greedy";
    EncodeOptions encode;
  };
  auto options = std::make_shared<Options>();
  CLI::App* verb = app.add_subcommand("encode", "Compress a matrix into a .vmat file");
  verb->add_option("MATRIX", options->in, "Matrix file, .bsp.h5 or .mtx")->required();
  verb->add_option("-o,--output", options->out, "The .vmat file to write")->required();
  verb->add_option("--codec", options->codec, "One of " + codec_names())->capture_default_str();
  verb->add_option(
          "--rows", options->order,
          "For codecs that want rows in order, zach3 and zach4: greedy order, or natural (as they stand)")
      ->check(CLI::IsMember({"greedy", "natural"}))
      ->capture_default_str();
  verb->add_option("--seconds", options->encode.seconds,
                   "For codecs that search, panne: search as long as this; what comes of it depends on the "
                   "machine. 0: until "
                   "little is found, the same on any")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  verb->add_option("--effort", options->encode.effort,
                   "For codecs that have more than one, gotsman3-context: 0 to 2; each step learns from four "
                   "times as much")
      ->capture_default_str();
  verb->add_option("--threads", options->encode.threads,
                   "0: one a core; the bytes are the same for any number")
      ->capture_default_str();
  verb->add_option("--seed", options->encode.seed, "Of the search of codecs that search")
      ->capture_default_str();
  verb->footer("Example: vismat encode city32.bsp.h5 --codec zach3-range -o city32.vmat");
  verb->callback([options] {
    const Codec& codec = find_codec(options->codec);
    if (options->encode.seconds > 0 && !codec.searches)
      throw std::invalid_argument("--seconds is for codecs that search; '" + options->codec + "' does not");
    if (options->encode.effort > codec.highest_effort) {
      throw std::invalid_argument(
          "--effort " + std::to_string(options->encode.effort) + ": '" + options->codec + "' has " +
          (codec.highest_effort == 0 ? "but one" : "0 to " + std::to_string(codec.highest_effort)));
    }
    Dataset data = read_dataset(options->in);
    if (const std::string why = obstacle(codec, data); !why.empty())
      throw std::invalid_argument(options->in.string() + ": " + why);
    const bool were_differences = !data.source.boundaries.empty();
    data =
        prepared_for(codec, std::move(data), {.orders = options->order == "greedy", .stages = show_progress});
    if (were_differences && data.source.boundaries.empty()) {
      std::printf(
          "the rows were differences between cells, known by their places; so the boundaries are left out, "
          "which "
          "--rows natural keeps\n");
    }
    if (codec.slow_encode) options->encode.progress = show_progress("encoding");
    Container container = compress(data, codec, options->encode);
    container.facts = facts_of(data);
    const auto file = write_container(container);
    write_file(options->out, file);
    const std::size_t payload = container.encoded.payload.size(), index = container.encoded.index.size();
    const std::uint64_t bitmap = bitmap_size(container.shape);
    std::printf("%s: %zu bytes of payload, %.2fx smaller than the bitmap's %llu", options->out.c_str(),
                payload, static_cast<double>(bitmap) / static_cast<double>(payload),
                static_cast<unsigned long long>(bitmap));
    const ContainerHead head(file);
    const auto tell = [&](const char* what, std::initializer_list<vmat::Section> sections) {
      std::size_t bytes = 0;
      for (const vmat::Section section : sections) bytes += head.section(section).size();
      if (bytes > 0) std::printf("; %s %zu bytes", what, bytes);
    };
    if (index > 0) std::printf("; index %zu bytes", index);
    using S = vmat::Section;
    tell("trees", {S::tree, S::row_tree});
    tell("orders", {S::row_order, S::column_order, S::shared_order});
    tell("groups", {S::row_groups, S::column_groups});
    tell("names", {S::row_names, S::column_names, S::column_levels});
    std::printf("\n");
  });
}

void add_decode(CLI::App& app) {
  struct Options {
    std::filesystem::path in, out;
    std::filesystem::path boxes;
    bool as_stored = false;
  };
  auto options = std::make_shared<Options>();
  CLI::App* verb = app.add_subcommand("decode", "Restore the matrix of a .vmat file, in the source's order");
  verb->add_option("FILE", options->in, "The .vmat file, of version 4 or 3")->required();
  verb->add_option("-o,--output", options->out, "Matrix file to write, .bsp.h5 or .mtx")->required();
  verb->add_flag("--as-stored", options->as_stored,
                 "Leave rows and columns in the order that they were given");
  verb->add_option("--boxes", options->boxes,
                   "A matrix file whose rows and columns have the boxes that the file was coded under, in "
                   "the file's order");
  verb->footer("Example: vismat decode city32.vmat -o city32.mtx");
  verb->callback([options] {
    Dataset boxes;
    if (!options->boxes.empty()) boxes = read_dataset(options->boxes);
    Dataset data = read_vmat_of_any_version(options->in, {nullptr, boxes.row_bounds, boxes.column_bounds});
    if (!options->as_stored) data = in_source_order(std::move(data));
    write_dataset(options->out, data);
    std::printf("%s: %u x %u, %llu ones\n", options->out.c_str(), data.matrix.shape().rows,
                data.matrix.shape().columns, static_cast<unsigned long long>(data.matrix.ones()));
  });
}

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
    const RowReader reader(options->in, all_codecs());
    const Shape shape = reader.shape();
    SourceMap source = reader.source();
    if (options->as_stored) source = {};
    if (!source.boundaries.empty()) {  // these are of the view cells, not of the lists
      source.row_order.reset();
      source.row_groups.reset();
    }
    std::uint32_t row = options->row;
    if (const std::uint32_t rows = source.row_groups ? source.row_groups->size() : shape.rows; row >= rows) {
      throw std::invalid_argument(options->in.string() + ": no row " + std::to_string(row) + "; it has " +
                                  std::to_string(rows));
    }
    if (source.row_order) row = source.row_order->new_of_old()[row];
    if (source.row_groups) row = source.row_groups->group_of_member()[row];
    RowBuffer<std::uint32_t> buffer;
    const auto stored = reader.ids(row, buffer);
    std::vector<std::uint32_t> ids(stored.begin(), stored.end());
    if (source.column_order) {
      const auto source_of = source.column_order->old_of_new();
      for (std::uint32_t& id : ids) id = source_of[id];
    }
    if (source.column_groups) {
      const VisibilityMatrix members = source.column_groups->members();
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
    const RowSource::Cost cost = reader.cost(row);
    std::fprintf(stderr, "row %u: %zu of %u visible, %llu bytes", options->row, ids.size(),
                 source.source_shape(shape).columns, static_cast<unsigned long long>(cost.bytes));
    if (cost.parts != 1) std::fprintf(stderr, " of %llu parts", static_cast<unsigned long long>(cost.parts));
    std::fprintf(stderr, "\n");
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
      "Over a tree of columns (zach...) a node's set is the view cells that see it, over one of rows "
      "(gotsman...) the "
      "objects that are seen from below it.\n"
      "Example: vismat node city32.vmat 0");
  verb->callback([options] {
    with_container(options->in, [&](const Container& container) {
      const Codec& codec = find_codec(container.codec);
      const bool over_rows = codec.needs.tree == TreeOver::rows;
      const ObjectTree* const tree = tree_for(codec, container.source);
      if (tree == nullptr || options->node >= tree->size()) {
        throw std::invalid_argument(options->in.string() + ": no node " + std::to_string(options->node) +
                                    "; it has " + std::to_string(tree ? tree->size() : 0));
      }
      const NodeReader reader(codec, Parts(container.encoded), container.shape, *tree);
      const NodeSet set = reader.set(options->node);
      const auto children = reader.children(set);
      const char* const of = over_rows ? "sees" : "visible from";
      const char* const what = over_rows ? "objects" : "view cells";
      std::printf("node %u: %s %zu of %u %s; %zu children in %llu bytes\n", options->node, of,
                  set.members.size(), over_rows ? container.shape.columns : container.shape.rows, what,
                  children.size(), static_cast<unsigned long long>(reader.part_bytes(options->node)));
      for (const NodeSet& child : children)
        std::printf("  child %8u: %s %8zu %s\n", child.node, of, child.members.size(), what);
      if (options->ids) {
        for (const std::uint32_t id : set.members) std::printf("%u\n", id);
      }
    });
  });
}

}  // namespace vismat::cli
