// ALGORITHM [Zach & Karner 2003, sections 3, 4.3 and Figure 1; Gotsman et al. 1999]. The common part of the tree
// codecs. Each node has a set that contains its children's. Over a tree of objects it is v(A), the view cells that see
// node A, since a child is visible only where its parent is. Over a tree of view cells it is the objects that are seen
// from somewhere below. So a child's bits are stored for the members of its parent's set alone and the rest is implied.
// Each node with children makes one part. Parts end on whole bytes, which lets a client keep each part in its node.
//
// Along the path from the root a reader learns more than the node's own set: which members are in the siblings' sets on
// the way. That is kept as `history` and `kind` for coders that want it.
#include "codecs/tree/tree_coding.h"

#include <algorithm>
#include <cassert>
#include <stdexcept>
#include <string>
#include <utility>

#include "codecs/tree/node_sets.h"

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
    if (const std::string wrong = too_many_bits(children, set.members.size(), ~std::size_t{0});
        !wrong.empty())
      throw std::invalid_argument(wrong);
    bits.bits.resize(children * set.members.size());
    marker.begin(set.members);
  };
  if (tree.size() > 0 && sets[0].size() < bits.universe) {
    NodeSet all;
    everything(bits.universe, all.members);
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
  std::vector<std::uint32_t> kind_of;
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
      inherit(set, bits.child(i), bits.child(1 - i), child, kind_of);
    }
  }
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

Encoded encode_over_tree(NodeCoder& coder, TreeOver over, const VisibilityMatrix& matrix, const Side& side,
                         const EncodeOptions& options) {
  check_fit(over, matrix, side.tree);
  const ObjectTree& tree = *side.tree;
  const SetsOfNodes sets(over, matrix, tree);
  const std::uint64_t passes = coder.learns() ? 2 : 1, total = passes * tree.size();
  const auto tell = [&](std::uint64_t pass, const ChildBits& node) {
    if (options.progress && node.set->node % 64 == 0)
      options.progress(pass * tree.size() + node.set->node, total);
  };
  if (coder.learns()) {
    std::uint64_t members = 0;
    for (std::uint32_t n = 0; n < tree.size(); ++n) members += tree.children(n).empty() ? 0 : sets[n].size();
    coder.expect(members, options);
    for_each_node(sets, tree, coder.wants_history(), [&](const ChildBits& node) {
      coder.see(node);
      tell(0, node);
    });
  }
  Encoded out;
  const bool root_everything = tree.size() == 0 || sets[0].size() == sets.universe();
  out.payload.push_back(static_cast<std::byte>(root_everything));
  coder.write_model(out.payload);
  std::vector<std::uint64_t> starts;
  for_each_node(sets, tree, coder.wants_history(), [&](const ChildBits& node) {
    starts.push_back(out.payload.size());
    coder.encode(node, out.payload);
    if (const std::string wrong =
            too_many_bits(node.children, node.members, out.payload.size() - starts.back());
        !wrong.empty())
      throw std::invalid_argument(wrong);
    tell(passes - 1, node);
  });
  if (!backed(sets.universe(), tree, out.payload.size())) {
    throw std::invalid_argument(std::to_string(sets.universe()) + " rows or columns in " +
                                std::to_string(out.payload.size()) + " bytes over a tree of " +
                                std::to_string(tree.size()) + " nodes; readers refuse so many in so few");
  }
  out.index = part_index_bytes(starts, out.payload.size());
  if (options.progress) options.progress(total, total);
  return out;
}

LengthStatistics length_statistics(const Codec& codec, const VisibilityMatrix& matrix,
                                   const ObjectTree* tree) {
  if (codec.node_coder == nullptr) return {};
  const auto coder = codec.node_coder();
  check_fit(codec.needs.tree, matrix, tree);
  for_each_node(SetsOfNodes(codec.needs.tree, matrix, *tree), *tree, coder->wants_history(),
                [&](const ChildBits& node) { coder->see(node); });
  return coder->statistics();
}

}  // namespace vismat
