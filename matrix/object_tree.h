// A hierarchy over objects (columns): a quadtree, a bounding volume tree, or a level's own BSP tree.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "matrix/box.h"
#include "matrix/visibility_matrix.h"

namespace vismat {

/// Nodes are numbered so that a parent comes before its children: node 0 is the root, and no cycle can be
/// written down. A node may hold an object; several nodes may hold the same one (a BSP cluster of many leafs).
class ObjectTree {
 public:
  static constexpr std::uint32_t none = 0xffffffff;

  ObjectTree() = default;
  /// parent_of_node[0] is `none`, parent_of_node[i] < i for the rest; object_of_node[i] < object_count or `none`.
  /// Throws std::invalid_argument naming the node otherwise, or if the lengths differ.
  static ObjectTree from_parents(std::vector<std::uint32_t> parent_of_node,
                                 std::vector<std::uint32_t> object_of_node, std::uint32_t object_count);

  std::uint32_t size() const { return static_cast<std::uint32_t>(parent_of_node_.size()); }
  std::uint32_t object_count() const { return object_count_; }
  std::span<const std::uint32_t> parent_of_node() const { return parent_of_node_; }
  std::span<const std::uint32_t> object_of_node() const { return object_of_node_; }
  /// Ascending; empty for a leaf. Borrowed: valid while *this lives.
  std::span<const std::uint32_t> children(std::uint32_t node) const {
    return {children_.data() + first_child_[node], first_child_[node + 1] - first_child_[node]};
  }
  bool operator==(const ObjectTree&) const = default;

 private:
  std::uint32_t object_count_ = 0;
  std::vector<std::uint32_t> parent_of_node_, object_of_node_;
  std::vector<std::uint32_t> first_child_ = {0}, children_;
};

/// One column a node: a node is visible wherever an object in its subtree is, so the result is monotone over the
/// tree. Requires tree.object_count() == objects.shape().columns. O(ones * depth).
VisibilityMatrix nodes_from_objects(const VisibilityMatrix& objects, const ObjectTree& tree);

/// Whether every node's column includes each of its children's; needs columns == tree.size().
bool is_monotone(const VisibilityMatrix& nodes, const ObjectTree& tree);

/// The least box around each node's objects; [0, 0] where a node has none. One box an object.
std::vector<Box> node_bounds(const ObjectTree& tree, std::span<const Box> of_objects);

}  // namespace vismat
