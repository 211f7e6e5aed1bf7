// vismat node: decodes the children of one tree node of a .vmat file without the rest.
#include <cstdio>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>

#include "cli/verbs.h"
#include "cli/vmat_files.h"
#include "codecs/baselines/baseline_codecs.h"
#include "codecs/tree/tree_coding.h"
#include "codecs/vmat/container.h"
#include "programs/options.h"

namespace vismat::cli {
namespace {

struct NodeOptions {
  std::filesystem::path in;
  std::uint32_t node = 0;
  bool ids = false;
};

void print_node(const Container& container, const NodeOptions& options) {
  const Codec& codec = find_codec(container.codec);
  const bool over_rows = codec.needs.tree == TreeOver::rows;
  const ObjectTree* const tree = tree_for(codec, container.source);
  if (tree == nullptr || options.node >= tree->size()) {
    throw std::invalid_argument(options.in.string() + ": no node " + std::to_string(options.node) +
                                "; it has " + std::to_string(tree ? tree->size() : 0));
  }
  const NodeReader reader(codec, Parts(container.encoded), container.shape, *tree);
  const NodeSet set = reader.set(options.node);
  const auto children = reader.children(set);
  const char* const of = over_rows ? "sees" : "visible from";
  const char* const what = over_rows ? "objects" : "view cells";
  std::printf("node %u: %s %zu of %u %s; %zu children in %llu bytes\n", options.node, of, set.members.size(),
              over_rows ? container.shape.columns : container.shape.rows, what, children.size(),
              static_cast<unsigned long long>(reader.part_bytes(options.node)));
  for (const NodeSet& child : children)
    std::printf("  child %8u: %s %8zu %s\n", child.node, of, child.members.size(), what);
  if (options.ids) {
    for (const std::uint32_t id : set.members) std::printf("%u\n", id);
  }
}

}  // namespace

void add_node(Program& program) {
  const auto options = std::make_shared<NodeOptions>();
  const Verb verb =
      program.verb("node", "Decode the children of one tree node of a .vmat file without the rest");
  verb.input("FILE", options->in, "A .vmat file of a codec over a tree").required();
  verb.option("NODE", options->node, "The number of the node; 0 is the root").required();
  verb.flag("--ids", options->ids, "Also print the numbers in the node's own set, as in the .vmat file");
  verb.note(
      "Over a tree of columns (zach codecs) a node's set holds the view cells from which it is visible; over "
      "a tree of rows (gotsman codecs) it holds the objects that are visible from anywhere below the node.");
  verb.example("vismat node city32.vmat 0");
  verb.runs([options] {
    with_container(options->in, [&](const Container& container) { print_node(container, *options); });
  });
}

}  // namespace vismat::cli
