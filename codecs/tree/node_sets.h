// The sets of a tree's nodes, and what writing and reading them share. Private to codecs/tree.
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "codecs/tree/tree_coding.h"

namespace vismat {

/// `part` becomes those of the whole whose bit is 1.
void take_marked(std::span<const std::uint32_t> whole, std::span<const std::uint8_t> bits,
                 std::vector<std::uint32_t>& part);

/// What is wrong with so many bits of a node; empty where nothing is. A bit of one node takes a byte of memory. What a tree and a
/// shape claim may be 2^64; a part's bytes back 2^16 each, and 2^28 go without. An encoder makes none that is refused.
std::string too_many_bits(std::size_t children, std::size_t members, std::size_t part_bytes);

/// 0, 1, ... up to the universe.
void everything(std::uint32_t universe, std::vector<std::uint32_t>& all);

/// Gives a child's set its history, from its parent's and from the bits of both children.
void inherit(const NodeSet& parent, std::span<const std::uint8_t> own, std::span<const std::uint8_t> sibling,
             NodeSet& child, std::vector<std::uint32_t>& kind_of);
/// Gives the root's set its history, of nothing.
void begin_history(NodeSet& root);

/// How many leaves the tree has below each node.
std::vector<std::uint32_t> leafs_of_nodes(const ObjectTree& tree);
/// What the tree tells of a node.
void place_in_tree(ChildBits& bits, const ObjectTree& tree, std::span<const std::uint32_t> leafs_of_node,
                   std::uint32_t node);

/// Each node's set. Of columns: a leaf's is its row, another's the union of its children's, which goes through a bit vector, or
/// where that is mostly empty by merging.
class SetsOfNodes {
 public:
  /// Borrows the matrix. Requires that the tree fits.
  SetsOfNodes(TreeOver side, const VisibilityMatrix& matrix, const ObjectTree& tree);
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

/// What is wrong with a tree over the columns or the rows; empty where nothing is.
std::string misfit(TreeOver side, const ObjectTree& tree, Shape shape);
/// Whether there are not too many rows or columns: those that the sets are of take memory though no byte stands for each.
bool backed(std::uint32_t universe, const ObjectTree& tree, std::uint64_t payload_bytes);

}  // namespace vismat
