// The way down from the root: each set is taken from its parent's by the bits of the parent's part.
#include <algorithm>
#include <cassert>
#include <stdexcept>
#include <string>
#include <utility>

#include "codecs/rows/pairs.h"
#include "codecs/tree/node_sets.h"
#include "codecs/tree/tree_coding.h"

namespace vismat {
namespace {

std::unique_ptr<NodeCoder> coder_of(const Codec& codec) {
  if (codec.node_coder == nullptr)
    throw std::invalid_argument(std::string(codec.name) +
                                " is no codec over a tree; it cannot read single nodes");
  return codec.node_coder();
}

}  // namespace

NodeReader::NodeReader(const Codec& codec, Parts parts, Shape shape, const ObjectTree& tree)
    : NodeReader(coder_of(codec), codec.needs.tree, std::move(parts), shape, tree) {}

NodeReader::NodeReader(std::unique_ptr<NodeCoder> coder, TreeOver over, Parts parts, Shape shape,
                       const ObjectTree& tree)
    : tree_(&tree), coder_(std::move(coder)), parts_(std::move(parts)), part_of_node_(tree.size(), no_part) {
  if (const std::string wrong = misfit(over, tree, shape); !wrong.empty()) throw FormatError(wrong);
  universe_ = over == TreeOver::columns ? shape.rows : shape.columns;
  if (!backed(universe_, tree, parts_.payload_bytes())) {
    throw FormatError("claims " + std::to_string(universe_) +
                      (over == TreeOver::columns ? " rows" : " columns") + " for " +
                      std::to_string(parts_.payload_bytes()) + " bytes over a tree of " +
                      std::to_string(tree.size()) + " nodes");
  }
  leafs_of_node_ = leafs_of_nodes(tree);
  if (over == TreeOver::rows) {
    node_of_row_.resize(shape.rows);
    for (std::uint32_t n = 0; n < tree.size(); ++n) {
      if (tree.children(n).empty()) node_of_row_[tree.object_of_node()[n]] = n;
    }
  }
  parts_.expect_no_sections();
  const auto model = parts_.model();
  ByteReader in(model, "payload");
  const auto flag = in.number<std::uint8_t>();
  if (flag > 1) in.fail("the root's flag is " + std::to_string(flag) + "; it must be 0 or 1");
  root_everything_ = flag == 1;
  coder_->read_model(in);
  if (in.left() != 0) in.fail(std::to_string(in.left()) + " bytes after the model");
  model_bytes_ = model.size();
  std::uint32_t part = root_everything_ || tree.size() == 0 ? 0 : 1;  // the root's own comes first
  for (std::uint32_t n = 0; n < tree.size(); ++n) {
    if (!tree.children(n).empty()) part_of_node_[n] = part++;
  }
  parts_.expect(part);
}

void NodeReader::read_root(NodeSet& root, ChildBits& bits) const {
  root.node = 0;
  everything(universe_, root.members);
  if (!root_everything_) {
    bits.children = 1;
    bits.members = bits.universe = universe_;
    bits.bits.assign(universe_, 0);
    bits.set = &root;
    bits.of_root = true;
    coder_->decode(parts_.part(0), bits);
    bits.of_root = false;
    std::size_t count = 0;
    for (std::uint32_t p = 0; p < universe_; ++p) {
      root.members[count] = p;
      count += bits.bits[p];
    }
    root.members.resize(count);
  }
  if (coder_->wants_history()) begin_history(root);
}

void NodeReader::read_children(const NodeSet& set, ChildBits& bits) const {
  bits.of_root = false;  // a damaged root may have left it so
  assert(!coder_->wants_history() || set.history.size() == set.members.size());
  bits.children = static_cast<std::uint32_t>(tree_->children(set.node).size());
  bits.members = static_cast<std::uint32_t>(set.members.size());
  bits.set = &set;
  bits.universe = universe_;
  place_in_tree(bits, *tree_, leafs_of_node_, set.node);
  try {
    const auto part = parts_.part(part_of_node_[set.node]);
    if (const std::string wrong = too_many_bits(bits.children, bits.members, part.size()); !wrong.empty())
      throw FormatError(wrong);
    bits.bits.assign(std::size_t{bits.children} * bits.members, 0);
    coder_->decode(part, bits);
  } catch (const FormatError& error) {
    throw FormatError("node " + std::to_string(set.node) + ": " + error.what());
  }
}

void NodeReader::take_child(const NodeSet& set, const ChildBits& bits, std::uint32_t child,
                            std::uint32_t node, NodeSet& out, std::vector<std::uint32_t>& kind_of) const {
  out.node = node;
  take_marked(set.members, bits.child(child), out.members);
  out.history.clear();
  out.kind.clear();
  if (coder_->wants_history() && !tree_->children(node).empty())
    inherit(set, bits.child(child), bits.child(1 - child), out, kind_of);
}

NodeSet NodeReader::root() const {
  NodeSet root;
  ChildBits bits;
  read_root(root, bits);
  return root;
}

std::vector<NodeSet> NodeReader::children(const NodeSet& set) const {
  const auto nodes = tree_->children(set.node);
  std::vector<NodeSet> out(nodes.size());
  if (nodes.empty()) return out;
  ChildBits bits;
  std::vector<std::uint32_t> kind_of;
  read_children(set, bits);
  for (std::uint32_t i = 0; i < bits.children; ++i) take_child(set, bits, i, nodes[i], out[i], kind_of);
  return out;
}

NodeSet NodeReader::set(std::uint32_t node) const {
  NodePath path;
  set(node, path);
  return std::move(path.sets_[path.depth_ - 1]);
}

const NodeSet& NodeReader::set(std::uint32_t node, NodePath& path) const {
  auto& [reader, sets, depth, bits, way, kind_of] = path;
  if (reader != self_) {
    reader = self_;
    depth = 0;
  }
  way.clear();  // from the node up to the root
  for (std::uint32_t n = node; n != ObjectTree::none; n = tree_->parent_of_node()[n]) way.push_back(n);
  std::reverse(way.begin(), way.end());
  if (sets.size() < way.size()) sets.resize(way.size());
  std::size_t shared = 0;
  while (shared < std::min(way.size(), depth) && sets[shared].node == way[shared]) ++shared;
  depth = shared;  // what a damaged part leaves half done does not count
  if (depth == 0) {
    read_root(sets[0], bits);
    depth = 1;
  }
  for (; depth < way.size(); ++depth) {
    const NodeSet& parent = sets[depth - 1];
    const auto siblings = tree_->children(parent.node);
    const auto place = std::find(siblings.begin(), siblings.end(), way[depth]) - siblings.begin();
    read_children(parent, bits);
    take_child(parent, bits, static_cast<std::uint32_t>(place), way[depth], sets[depth], kind_of);
  }
  return sets[depth - 1];
}

RowSource::Cost NodeReader::cost(std::uint32_t node) const {
  RowSource::Cost cost;
  if (!root_everything_) cost = {parts_.part_bytes(0), 1};
  for (std::uint32_t n = node; n != 0; ++cost.parts) {
    n = tree_->parent_of_node()[n];
    cost.bytes += part_bytes(n);
  }
  return cost;
}

namespace {

const ObjectTree& tree_of(const Side& side) {
  if (side.tree == nullptr) throw FormatError("this payload needs its tree");
  return *side.tree;
}

class RowsOverTree final : public RowSource {
 public:
  RowsOverTree(std::unique_ptr<NodeCoder> coder, Parts parts, Shape shape, const ObjectTree& tree)
      : reader_(std::move(coder), TreeOver::rows, std::move(parts), shape, tree) {}
  void read(std::uint32_t row, RowScratch& scratch, IdSink& sink) const override { put(row, scratch, sink); }
  void read(std::uint32_t row, RowScratch& scratch, RunSink& sink) const override { put(row, scratch, sink); }
  void read(std::uint32_t row, RowScratch& scratch, BitSink& sink) const override { put(row, scratch, sink); }
  Cost cost(std::uint32_t row) const override { return reader_.cost(reader_.node_of_row(row)); }

 private:
  template <typename Sink>
  void put(std::uint32_t row, RowScratch& scratch, Sink& sink) const {
    const NodeSet& set = reader_.set(reader_.node_of_row(row), scratch.as<NodePath>());
    for_each_run(std::span<const std::uint32_t>(set.members),
                 [&](std::uint32_t first, std::uint32_t count) { sink.run(first - sink.next(), count); });
  }
  NodeReader reader_;
};

}  // namespace

std::unique_ptr<const RowSource> open_over_tree(std::unique_ptr<NodeCoder> coder, Parts parts, Shape shape,
                                                const Side& side) {
  return std::make_unique<RowsOverTree>(std::move(coder), std::move(parts), shape, tree_of(side));
}

// From the root down, each set once: by rows alone, those near the root would be read again and again.
VisibilityMatrix decode_over_tree(std::unique_ptr<NodeCoder> coder, TreeOver over, const Parts& parts,
                                  Shape shape, const Side& side, std::uint64_t most) {
  const ObjectTree& tree = tree_of(side);
  const NodeReader reader(std::move(coder), over, parts, shape, tree);
  const bool over_rows = over == TreeOver::rows;
  std::vector<NodeSet> reached(tree.size());
  std::vector<std::vector<std::uint32_t>> out(over_rows ? shape.rows : tree.size());
  std::uint64_t ones = 0;
  const auto put = [&](std::uint32_t place, std::vector<std::uint32_t>& ids) {
    if (ids.size() > most - ones) throw FormatError("more ones than the file states");
    ones += ids.size();
    out[place] = std::move(ids);
  };
  if (tree.size() > 0) reached[0] = reader.root();
  for (std::uint32_t n = 0; n < tree.size(); ++n) {
    NodeSet set = std::exchange(reached[n], {});
    for (NodeSet& child : reader.children(set)) reached[child.node] = std::move(child);
    if (!over_rows)
      put(n, set.members);
    else if (tree.children(n).empty())
      put(tree.object_of_node()[n], set.members);
  }
  return over_rows ? VisibilityMatrix::from_rows(out, shape.columns)
                   : transpose(VisibilityMatrix::from_rows(out, shape.rows));
}

}  // namespace vismat
