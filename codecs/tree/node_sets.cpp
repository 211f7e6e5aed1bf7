#include "codecs/tree/node_sets.h"

#include <algorithm>
#include <bit>
#include <numeric>
#include <utility>

namespace vismat {
namespace {

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

}  // namespace

void take_marked(std::span<const std::uint32_t> whole, std::span<const std::uint8_t> bits,
                 std::vector<std::uint32_t>& part) {
  part.resize(whole.size());
  std::size_t count = 0;
  for (std::size_t p = 0; p < whole.size(); ++p) {
    part[count] = whole[p];
    count += bits[p];
  }
  part.resize(count);
}

std::string too_many_bits(std::size_t children, std::size_t members, std::size_t part_bytes) {
  const std::size_t most = std::min<std::size_t>(
      std::size_t{1} << 31, (std::size_t{1} << 28) + std::min<std::size_t>(part_bytes, 1 << 20) * 65536);
  if (members == 0 || children <= most / members) return {};
  return std::to_string(children) + " children over a set of " + std::to_string(members) +
         " are too many for one node; a part of " + std::to_string(part_bytes) + " bytes may have " +
         std::to_string(most) + " pairs at most";
}

void everything(std::uint32_t universe, std::vector<std::uint32_t>& all) {
  all.resize(universe);
  std::iota(all.begin(), all.end(), 0u);
}

void inherit(const NodeSet& parent, std::span<const std::uint8_t> own, std::span<const std::uint8_t> sibling,
             NodeSet& child, std::vector<std::uint32_t>& kind_of) {
  const std::size_t count = child.members.size();
  child.history.resize(count);
  child.kind.resize(count);
  constexpr std::uint32_t unseen = 0xffffffff;
  kind_of.assign(2 * parent.kind.size(), unseen);
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

void place_in_tree(ChildBits& bits, const ObjectTree& tree, std::span<const std::uint32_t> leafs_of_node,
                   std::uint32_t node) {
  bits.leafs = leafs_of_node[node];
  bits.first_child = node > 0 && tree.children(tree.parent_of_node()[node])[0] == node;
}

SetsOfNodes::SetsOfNodes(TreeOver side, const VisibilityMatrix& matrix, const ObjectTree& tree)
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

bool backed(std::uint32_t universe, const ObjectTree& tree, std::uint64_t payload_bytes) {
  return universe <= (std::uint64_t{1} << 24) + 4096 * (payload_bytes + tree.size());
}

}  // namespace vismat
