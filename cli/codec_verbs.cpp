// encode, decode, node: matrix files to .vmat and back, and one node of a .vmat alone.
#include <cstdio>
#include <filesystem>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <string>

#include "cli/progress.h"
#include "cli/verbs.h"
#include "codecs/baseline_codecs.h"
#include "codecs/bitmap.h"
#include "codecs/container.h"
#include "codecs/tree_coding.h"
#include "layout/greedy_order.h"
#include "matrix/atomic_file.h"
#include "matrix/dataset.h"

namespace vismat::cli {
namespace {

std::string codec_names() {
  std::string names;
  for (const Codec& codec : all_codecs()) names += (names.empty() ? "" : ", ") + std::string(codec.name);
  return names;
}

// The facts that Container keeps, a line each; provenance is one line by definition.
std::string facts_of(const Dataset& data) {
  std::string facts = "rows_are: " + data.rows_are + "\ncolumns_are: " + data.columns_are + "\n";
  facts += "guarantee: " + std::string(to_string(data.guarantee)) + "\n";
  if (data.columns_are_nodes) facts += "columns_are_nodes: yes\n";
  if (data.seed) facts += "seed: " + std::to_string(*data.seed) + "\n";
  if (!data.provenance.empty()) facts += "provenance: " + data.provenance + "\n";
  return facts;
}

void read_facts(const std::string& facts, Dataset& data) {
  std::istringstream lines(facts);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t colon = line.find(": ");
    if (colon == std::string::npos) throw FormatError("facts: a line without ': '");
    const std::string key = line.substr(0, colon), value = line.substr(colon + 2);
    if (key == "rows_are") data.rows_are = value;
    if (key == "columns_are") data.columns_are = value;
    if (key == "columns_are_nodes") data.columns_are_nodes = value == "yes";
    if (key == "provenance") data.provenance = value;
    try {
      if (key == "guarantee") data.guarantee = guarantee_from_string(value);
      if (key == "seed") data.seed = std::stoull(value);
    } catch (const std::logic_error& error) {
      throw FormatError("facts: " + key + ": " + error.what());
    }
  }
}

// Calls work with the container of the file; what goes wrong names the file.
template <typename Work>
void with_container(const std::filesystem::path& path, const Work& work) {
  const auto bytes = read_file(path);
  try {
    const Container container = read_container(bytes);
    work(container);
  } catch (const FormatError& error) {
    throw FormatError(path.string() + ": " + error.what());
  }
}

}  // namespace

void add_encode(CLI::App& app) {
  struct Options {
    std::filesystem::path in, out;
    std::string codec = "zach3-huffman", order = "greedy";
  };
  auto options = std::make_shared<Options>();
  CLI::App* verb = app.add_subcommand("encode", "Compress a matrix into a .vmat file");
  verb->add_option("MATRIX", options->in, "Matrix file, .bsp.h5 or .mtx")->required();
  verb->add_option("-o,--output", options->out, "The .vmat file to write")->required();
  verb->add_option("--codec", options->codec, "One of " + codec_names())->capture_default_str();
  verb->add_option("--rows", options->order, "Order of rows: greedy, or natural (as they stand)")
      ->check(CLI::IsMember({"greedy", "natural"}))
      ->capture_default_str();
  verb->footer("Example: vismat encode city32.bsp.h5 --codec zach3-range -o city32.vmat");
  verb->callback([options] {
    const Codec& codec = find_codec(options->codec);
    Dataset data = read_dataset(options->in);
    if (codec.over_tree && data.tree && !data.columns_are_nodes) data = over_nodes(data);
    Permutation order;
    const bool reorder = codec.wants_row_order && options->order == "greedy";
    if (reorder) order = order_rows_greedily(data.matrix, show_progress("ordering rows"));
    Container container =
        compress(data.matrix, codec, data.tree ? &*data.tree : nullptr, reorder ? &order : nullptr);
    container.facts = facts_of(data);
    write_file(options->out, write_container(container));
    const std::size_t payload = container.encoded.payload.size(), index = container.encoded.node_index.size();
    std::printf("%s: %zu bytes of payload, %.2fx smaller than the bitmap's %llu", options->out.c_str(),
                payload, static_cast<double>(bitmap_size(data.matrix.shape())) / static_cast<double>(payload),
                static_cast<unsigned long long>(bitmap_size(data.matrix.shape())));
    if (index > 0) std::printf("; node index %zu bytes", index);
    if (reorder) std::printf("; row order %llu bytes", 4ull * data.matrix.shape().rows);
    std::printf("\n");
  });
}

void add_decode(CLI::App& app) {
  struct Options {
    std::filesystem::path in, out;
  };
  auto options = std::make_shared<Options>();
  CLI::App* verb = app.add_subcommand("decode", "Restore the matrix of a .vmat file");
  verb->add_option("FILE", options->in, "The .vmat file")->required();
  verb->add_option("-o,--output", options->out, "Matrix file to write, .bsp.h5 or .mtx")->required();
  verb->footer("Example: vismat decode city32.vmat -o city32.mtx");
  verb->callback([options] {
    with_container(options->in, [&](const Container& container) {
      Dataset data;
      read_facts(container.facts, data);
      data.matrix = decompress(container, find_codec(container.codec));
      data.tree = container.tree;
      if (const std::uint32_t columns = container.shape.columns;
          data.tree ? (data.columns_are_nodes ? data.tree->size() : data.tree->object_count()) != columns
                    : data.columns_are_nodes) {
        throw FormatError("tree section: does not fit the " + std::to_string(columns) + " columns");
      }
      write_dataset(options->out, data);
      std::printf("%s: %u x %u, %llu ones\n", options->out.c_str(), data.matrix.shape().rows,
                  data.matrix.shape().columns, static_cast<unsigned long long>(data.matrix.ones()));
    });
  });
}

void add_node(CLI::App& app) {
  struct Options {
    std::filesystem::path in;
    std::uint32_t node = 0;
  };
  auto options = std::make_shared<Options>();
  CLI::App* verb =
      app.add_subcommand("node", "Decode one tree node's children from a .vmat file, without the rest");
  verb->add_option("FILE", options->in, "A .vmat file of a codec over a tree")->required();
  verb->add_option("NODE", options->node, "Node number, 0 is the root")->required();
  verb->footer("Example: vismat node city32.vmat 0");
  verb->callback([options] {
    with_container(options->in, [&](const Container& container) {
      if (!container.tree || options->node >= container.tree->size()) {
        throw std::invalid_argument(options->in.string() + ": no node " + std::to_string(options->node) +
                                    "; it has " +
                                    std::to_string(container.tree ? container.tree->size() : 0));
      }
      const NodeReader reader(container.codec, container.encoded.payload, container.encoded.node_index,
                              container.shape, *container.tree);
      const auto cells = reader.cells(options->node);
      const auto children = reader.children(options->node, cells);
      std::printf("node %u: visible from %zu of %u view cells; %zu children in %llu bytes\n", options->node,
                  cells.size(), container.shape.rows, children.size(),
                  static_cast<unsigned long long>(reader.part_bytes(options->node)));
      for (std::size_t i = 0; i < children.size(); ++i) {
        std::printf("  child %8u: visible from %8zu view cells\n", container.tree->children(options->node)[i],
                    children[i].size());
      }
    });
  });
}

}  // namespace vismat::cli
