// ALGORITHM [Zach & Karner 2003, sections 3, 4.3 and Figure 1; Gotsman et al. 1999]. Each node has a set that holds its
// children's: over a tree of columns v(A), the cells that see node A, where a child is visible only where its parent is; over
// a tree of rows the objects that are seen from somewhere below. So a child's bits are kept for the members of its parent's set
// alone and the rest is implied. Each node with children makes one part; parts end on whole bytes, which costs half a byte a
// node (0.1 % on the artificial sets) and lets a client keep each part in its node.
//
// Who walks down the tree learns more than the node's own set: where each member is in the siblings' sets on the way. That is
// carried along as `history` and `kind` for coders that want it.
#include "codecs/tree_coding.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>

#include "codecs/bit_stream.h"

namespace vismat {
namespace {

constexpr const char* not_monotone =
    "the matrix is not monotone over its tree: some node is hidden where its child is visible";

// Marks where the members of a part stand among those of the whole.
class Marker {
 public:
  explicit Marker(std::uint32_t universe) : place_(universe, 0) {}
  void begin(std::span<const std::uint32_t> whole) {
    whole_ = whole;
    for (std::uint32_t p = 0; p < whole.size(); ++p) place_[whole[p]] = p;
  }
  // std::invalid_argument where the part has a member that the whole has not.
  void mark(std::span<const std::uint32_t> part, std::uint8_t* bits) const {
    std::fill_n(bits, whole_.size(), std::uint8_t{0});
    for (const std::uint32_t member : part) {
      const std::uint32_t p = place_[member];
      if (p >= whole_.size() || whole_[p] != member) throw std::invalid_argument(not_monotone);
      bits[p] = 1;
    }
  }

 private:
  std::vector<std::uint32_t> place_;  // what others left there is found out by looking back
  std::span<const std::uint32_t> whole_;
};

template <typename Number>
std::vector<Number> marked(std::span<const Number> whole, std::span<const std::uint8_t> bits) {
  std::vector<Number> part(whole.size());
  std::size_t count = 0;
  for (std::size_t p = 0; p < whole.size(); ++p) {
    part[count] = whole[p];
    count += bits[p];
  }
  part.resize(count);
  return part;
}

// 2^31 bits of one node are 2 GB here; a hostile tree and shape could ask for 2^64.
std::size_t checked_size(std::size_t children, std::size_t members) {
  if (members != 0 && children > (std::size_t{1} << 31) / members) {
    throw FormatError(std::to_string(children) + " children over a set of " + std::to_string(members) +
                      " are too many for one node; at most 2^31 pairs");
  }
  return children * members;
}

std::vector<std::uint32_t> everything(std::uint32_t universe) {
  std::vector<std::uint32_t> all(universe);
  std::iota(all.begin(), all.end(), 0u);
  return all;
}

// Gives a child's set its history, from its parent's and from the bits of both children.
void inherit(const NodeSet& parent, std::span<const std::uint8_t> own, std::span<const std::uint8_t> sibling,
             NodeSet& child) {
  const std::size_t count = child.members.size();
  child.history.resize(count);
  child.kind.resize(count);
  constexpr std::uint32_t unseen = 0xffffffff;
  std::vector<std::uint32_t> kind_of(2 * parent.kind.size(), unseen);
  std::uint32_t kinds = 0;
  for (std::size_t p = 0, at = 0; p < own.size(); ++p) {
    if (own[p] == 0) continue;
    child.history[at] = static_cast<std::uint8_t>(parent.history[p] << 1 | sibling[p]);
    std::uint32_t& kind = kind_of[2 * parent.kind[p] + sibling[p]];
    if (kind == unseen) kind = kinds++;
    child.kind[at++] = kind;
  }
}

void begin_history(NodeSet& root) {
  root.history.assign(root.members.size(), 0);
  root.kind.assign(root.members.size(), 0);
}

std::vector<std::uint32_t> leafs_of_nodes(const ObjectTree& tree) {
  std::vector<std::uint32_t> leafs(tree.size(), 0);
  for (std::uint32_t n = tree.size(); n-- > 0;) {
    if (tree.children(n).empty()) leafs[n] = 1;
    if (n > 0) leafs[tree.parent_of_node()[n]] += leafs[n];
  }
  return leafs;
}

// What the tree tells of a node.
void place_in_tree(ChildBits& bits, const ObjectTree& tree, std::span<const std::uint32_t> leafs_of_node,
                   std::uint32_t node) {
  bits.leafs = leafs_of_node[node];
  bits.first_child = node > 0 && tree.children(tree.parent_of_node()[node])[0] == node;
}

// A word is written once for all of its ids: writing it for each would wait each time for the last.
void set_bits(std::span<const std::uint32_t> ids, std::span<std::uint64_t> words) {
  std::uint64_t bits = 0;
  std::size_t at = 0;
  for (const std::uint32_t id : ids) {
    if (id / 64 != at) {
      words[at] |= std::exchange(bits, 0);
      at = id / 64;
    }
    bits |= std::uint64_t{1} << id % 64;
  }
  if (bits != 0) words[at] |= bits;
}

// Each node's set. Of columns: a leaf's is its row, another's the union of its children's, which goes through a bit vector, or
// where that is mostly empty by merging.
class SetsOfNodes {
 public:
  // Borrows the matrix. Requires that the tree fits.
  SetsOfNodes(TreeOver side, const VisibilityMatrix& matrix, const ObjectTree& tree)
      : universe_(side == TreeOver::columns ? matrix.shape().rows : matrix.shape().columns),
        set_of_node_(tree.size()) {
    if (side == TreeOver::columns) {
      columns_ = transpose(matrix);
      for (std::uint32_t n = 0; n < tree.size(); ++n) set_of_node_[n] = columns_.row(n);
      return;
    }
    unions_.resize(tree.size());
    std::vector<std::uint64_t> words((std::size_t{universe_} + 63) / 64, 0);
    std::vector<std::uint32_t> united(universe_);
    for (std::uint32_t n = tree.size(); n-- > 0;) {
      const auto children = tree.children(n);
      if (children.empty()) {
        set_of_node_[n] = matrix.row(tree.object_of_node()[n]);
        continue;
      }
      const auto first = set_of_node_[children[0]], second = set_of_node_[children[1]];
      auto* end = united.data();
      if (first.size() + second.size() < words.size() / 2) {
        end = std::set_union(first.begin(), first.end(), second.begin(), second.end(), end);
      } else {
        set_bits(first, words);
        set_bits(second, words);
        for (std::size_t w = 0; w < words.size(); ++w) {
          for (std::uint64_t left = std::exchange(words[w], 0); left != 0; left &= left - 1)
            *end++ = static_cast<std::uint32_t>(64 * w) + static_cast<std::uint32_t>(std::countr_zero(left));
        }
      }
      unions_[n].assign(united.data(), end);
      set_of_node_[n] = unions_[n];
    }
  }
  SetsOfNodes(const SetsOfNodes&) = delete;
  SetsOfNodes& operator=(const SetsOfNodes&) = delete;

  std::uint32_t universe() const { return universe_; }
  std::span<const std::uint32_t> operator[](std::uint32_t node) const { return set_of_node_[node]; }

 private:
  std::uint32_t universe_;
  VisibilityMatrix columns_;
  std::vector<std::vector<std::uint32_t>> unions_;  // of nodes with children
  std::vector<std::span<const std::uint32_t>> set_of_node_;
};

// Calls visit(ChildBits) for the root, where its set is not everything, and then for each node that has
// children. Throws std::invalid_argument where the sets are not monotone over the tree.
template <typename Visit>
void for_each_node(const SetsOfNodes& sets, const ObjectTree& tree, bool history, const Visit& visit) {
  ChildBits bits;
  bits.universe = sets.universe();
  Marker marker(bits.universe);
  const auto begin = [&](const NodeSet& set, std::size_t children) {
    bits.set = &set;
    bits.children = static_cast<std::uint32_t>(children);
    bits.members = static_cast<std::uint32_t>(set.members.size());
    bits.bits.resize(checked_size(bits.children, bits.members));
    marker.begin(set.members);
  };
  if (tree.size() > 0 && sets[0].size() < bits.universe) {
    NodeSet all;
    all.members = everything(bits.universe);
    begin(all, 1);
    marker.mark(sets[0], bits.bits.data());
    bits.of_root = true;
    visit(bits);
    bits.of_root = false;
  }
  const std::vector<std::uint32_t> leafs_of_node = leafs_of_nodes(tree);
  std::vector<NodeSet> reached(history ? tree.size()
                                       : 0);  // with histories, from its parent's turn to its own
  if (!reached.empty()) {
    reached[0].members.assign(sets[0].begin(), sets[0].end());
    begin_history(reached[0]);
  }
  NodeSet set;
  for (std::uint32_t n = 0; n < tree.size(); ++n) {
    const auto children = tree.children(n);
    if (history) set = std::exchange(reached[n], {});
    if (children.empty()) continue;
    set.node = n;
    set.members.assign(sets[n].begin(), sets[n].end());
    begin(set, children.size());
    for (std::uint32_t i = 0; i < children.size(); ++i)
      marker.mark(sets[children[i]], bits.bits.data() + std::size_t{i} * bits.members);
    place_in_tree(bits, tree, leafs_of_node, n);
    visit(bits);
    for (std::uint32_t i = 0; history && i < children.size(); ++i) {
      if (tree.children(children[i]).empty()) continue;
      NodeSet& child = reached[children[i]];
      child.members.resize(sets[children[i]].size());
      inherit(set, bits.child(i), bits.child(1 - i), child);
    }
  }
}

// What is wrong with a tree over the columns or the rows; empty where nothing is.
std::string misfit(TreeOver side, const ObjectTree& tree, Shape shape) {
  const std::string nodes = std::to_string(tree.size());
  if (side == TreeOver::columns) {
    if (tree.size() == shape.columns) return {};
    return "the tree has " + nodes + " nodes but the matrix has " + std::to_string(shape.columns) +
           " columns; this codec needs one column a node ('vismat tree --nodes')";
  }
  if (tree.object_count() != shape.rows) {
    return "the tree over the rows has " + std::to_string(tree.object_count()) +
           " objects but the matrix has " + std::to_string(shape.rows) + " rows";
  }
  std::vector<bool> told(shape.rows, false);
  for (std::uint32_t n = 0; n < tree.size(); ++n) {
    const std::uint32_t row = tree.object_of_node()[n];
    const std::size_t children = tree.children(n).size();
    const std::string node = "the tree over the rows: node " + std::to_string(n);
    if (children != 0 && children != 2) {
      return node + " has " + std::to_string(children) +
             " children; this codec needs two everywhere ('vismat tree --side rows')";
    }
    if ((children == 0) != (row != ObjectTree::none))
      return node + (children == 0 ? " is a leaf without a row" : " has children and a row");
    if (row == ObjectTree::none) continue;
    if (told[row]) return node + " holds row " + std::to_string(row) + ", as another does";
    told[row] = true;
  }
  for (std::uint32_t r = 0; r < shape.rows; ++r) {
    if (!told[r]) return "the tree over the rows: no leaf holds row " + std::to_string(r);
  }
  return {};
}

void check_fit(TreeOver side, const VisibilityMatrix& matrix, const ObjectTree* tree) {
  if (tree == nullptr) {
    throw std::invalid_argument(
        side == TreeOver::columns
            ? "this codec needs a tree over the columns; make one with 'vismat tree'"
            : "this codec needs a tree over the rows; make one with 'vismat tree --side rows'");
  }
  if (const std::string wrong = misfit(side, *tree, matrix.shape()); !wrong.empty())
    throw std::invalid_argument(wrong);
}

}  // namespace

std::unique_ptr<NodeCoder> make_node_coder(std::string_view codec) {
  auto coder = make_zach_coder(codec);
  return coder ? std::move(coder) : make_gotsman_coder(codec);
}

Encoded encode_over_tree(NodeCoder& coder, const VisibilityMatrix& matrix, const ObjectTree* tree) {
  check_fit(coder.side(), matrix, tree);
  const SetsOfNodes sets(coder.side(), matrix, *tree);
  if (coder.learns()) {
    std::uint64_t members = 0;
    for (std::uint32_t n = 0; n < tree->size(); ++n)
      members += tree->children(n).empty() ? 0 : sets[n].size();
    coder.expect(members);
    for_each_node(sets, *tree, coder.wants_history(), [&](const ChildBits& node) { coder.see(node); });
  }
  Encoded out;
  const bool root_everything = tree->size() == 0 || sets[0].size() == sets.universe();
  out.payload.push_back(static_cast<std::byte>(root_everything));
  coder.write_model(out.payload);
  for_each_node(sets, *tree, coder.wants_history(), [&](const ChildBits& node) {
    const std::size_t before = out.payload.size();
    coder.encode(node, out.payload);
    put_varint(out.index, out.payload.size() - before);
  });
  return out;
}

LengthStatistics length_statistics(const Codec& codec, const VisibilityMatrix& matrix,
                                   const ObjectTree* tree) {
  const auto coder = make_node_coder(codec.name);
  if (!coder) return {};
  check_fit(coder->side(), matrix, tree);
  for_each_node(SetsOfNodes(coder->side(), matrix, *tree), *tree, coder->wants_history(),
                [&](const ChildBits& node) { coder->see(node); });
  return coder->statistics();
}

NodeReader::NodeReader(std::string_view codec, std::span<const std::byte> payload,
                       std::span<const std::byte> node_index, Shape shape, const ObjectTree& tree)
    : tree_(&tree), coder_(make_node_coder(codec)), part_of_node_(tree.size()) {
  if (!coder_)
    throw std::invalid_argument(std::string(codec) + " is no codec over a tree; it cannot read single nodes");
  if (const std::string wrong = misfit(side(), tree, shape); !wrong.empty()) throw FormatError(wrong);
  universe_ = side() == TreeOver::columns ? shape.rows : shape.columns;
  leafs_of_node_ = leafs_of_nodes(tree);
  if (side() == TreeOver::rows) {
    node_of_row_.resize(shape.rows);
    for (std::uint32_t n = 0; n < tree.size(); ++n) {
      if (tree.children(n).empty()) node_of_row_[tree.object_of_node()[n]] = n;
    }
  }
  ByteReader in(payload, "payload"), index(node_index, "node index");
  const auto flag = in.number<std::uint8_t>();
  if (flag > 1) in.fail("the root's flag is " + std::to_string(flag) + "; it must be 0 or 1");
  root_everything_ = flag == 1;
  coder_->read_model(in);
  model_bytes_ = in.offset();
  if (!root_everything_ && tree.size() > 0) root_part_ = in.bytes(index.varint());
  for (std::uint32_t n = 0; n < tree.size(); ++n) {
    if (!tree.children(n).empty()) part_of_node_[n] = in.bytes(index.varint());
  }
  if (in.left() != 0) in.fail(std::to_string(in.left()) + " bytes more than the node index accounts for");
  if (index.left() != 0)
    index.fail(std::to_string(index.left()) + " bytes more than the tree has nodes with children");
}

NodeSet NodeReader::root() const {
  NodeSet root;
  root.members = everything(universe_);
  if (!root_everything_) {
    ChildBits bits;
    bits.children = 1;
    bits.members = bits.universe = universe_;
    bits.bits.resize(universe_);
    bits.set = &root;
    bits.of_root = true;
    coder_->decode(root_part_, bits);
    root.members = marked<std::uint32_t>(root.members, bits.bits);
  }
  if (coder_->wants_history()) begin_history(root);
  return root;
}

std::vector<NodeSet> NodeReader::children(const NodeSet& set) const {
  const auto nodes = tree_->children(set.node);
  assert(!coder_->wants_history() || set.history.size() == set.members.size());
  std::vector<NodeSet> out(nodes.size());
  if (nodes.empty()) return out;
  ChildBits bits;
  bits.children = static_cast<std::uint32_t>(nodes.size());
  bits.members = static_cast<std::uint32_t>(set.members.size());
  bits.set = &set;
  bits.universe = universe_;
  place_in_tree(bits, *tree_, leafs_of_node_, set.node);
  try {
    bits.bits.resize(checked_size(bits.children, bits.members));
    coder_->decode(part_of_node_[set.node], bits);
  } catch (const FormatError& error) {
    throw FormatError("node " + std::to_string(set.node) + ": " + error.what());
  }
  for (std::uint32_t i = 0; i < bits.children; ++i) {
    out[i].node = nodes[i];
    out[i].members = marked<std::uint32_t>(set.members, bits.child(i));
    if (coder_->wants_history() && !tree_->children(nodes[i]).empty())
      inherit(set, bits.child(i), bits.child(1 - i), out[i]);
  }
  return out;
}

NodeSet NodeReader::set(std::uint32_t node) const {
  NodePath path;
  set(node, path);
  return std::move(path.sets.back());
}

const NodeSet& NodeReader::set(std::uint32_t node, NodePath& path) const {
  std::vector<std::uint32_t> way;  // from the node up to the root
  for (std::uint32_t n = node; n != ObjectTree::none; n = tree_->parent_of_node()[n]) way.push_back(n);
  std::reverse(way.begin(), way.end());
  auto& sets = path.sets;
  std::size_t shared = 0;
  while (shared < std::min(way.size(), sets.size()) && sets[shared].node == way[shared]) ++shared;
  sets.resize(shared);
  if (shared == 0) sets.push_back(root());
  while (sets.size() < way.size()) {
    const auto siblings = tree_->children(way[sets.size() - 1]);
    const auto place = std::find(siblings.begin(), siblings.end(), way[sets.size()]) - siblings.begin();
    auto all = children(sets.back());
    sets.push_back(std::move(all[static_cast<std::size_t>(place)]));
  }
  return sets.back();
}

NodeReader::Cost NodeReader::cost(std::uint32_t node) const {
  Cost cost{root_part_.size(), root_everything_ ? 0u : 1u};
  for (std::uint32_t n = node; n != 0; ++cost.parts) {
    n = tree_->parent_of_node()[n];
    cost.bytes += part_bytes(n);
  }
  return cost;
}

VisibilityMatrix decode_over_tree(std::string_view codec, std::span<const std::byte> payload,
                                  std::span<const std::byte> node_index, Shape shape,
                                  const ObjectTree* tree) {
  if (tree == nullptr) throw FormatError("the payload of " + std::string(codec) + " needs its tree");
  const NodeReader reader(codec, payload, node_index, shape, *tree);
  const bool over_rows = reader.side() == TreeOver::rows;
  std::vector<NodeSet> reached(tree->size());
  std::vector<std::vector<std::uint32_t>> out(over_rows ? shape.rows : tree->size());
  if (tree->size() > 0) reached[0] = reader.root();
  for (std::uint32_t n = 0; n < tree->size(); ++n) {
    NodeSet set = std::exchange(reached[n], {});
    for (NodeSet& child : reader.children(set)) reached[child.node] = std::move(child);
    if (!over_rows)
      out[n] = std::move(set.members);
    else if (tree->children(n).empty())
      out[tree->object_of_node()[n]] = std::move(set.members);
  }
  return over_rows ? VisibilityMatrix::from_rows(out, shape.columns)
                   : transpose(VisibilityMatrix::from_rows(out, shape.rows));
}

}  // namespace vismat
