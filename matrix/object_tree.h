// A tree over objects (columns): a quadtree, a tree of bounding boxes, or a level's own BSP tree.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "matrix/box.h"
#include "matrix/visibility_matrix.h"

namespace vismat {

/// A tree whose nodes are numbered so that a parent comes before its children: node 0 is the root, and no cycle can be
/// written down. A node may hold an object; several nodes may hold the same one (a cluster of a level with many BSP
/// leaves).
class ObjectTree {
 public:
  static constexpr std::uint32_t none = 0xffffffff;

  ObjectTree() = default;
  /// parent_of_node[0] is `none`, and parent_of_node[i] < i for the other nodes; object_of_node[i] < object_count, or
  /// `none`. Otherwise, and if the lengths differ, throws std::invalid_argument naming the node.
  static ObjectTree from_parents(std::vector<std::uint32_t> parent_of_node,
                                 std::vector<std::uint32_t> object_of_node, std::uint32_t object_count);

  std::uint32_t size() const { return static_cast<std::uint32_t>(parent_of_node_.size()); }
  std::uint32_t object_count() const { return object_count_; }
  std::span<const std::uint32_t> parent_of_node() const { return parent_of_node_; }
  std::span<const std::uint32_t> object_of_node() const { return object_of_node_; }
  /// The children in ascending order; empty for a leaf. Borrowed: valid while *this lives.
  std::span<const std::uint32_t> children(std::uint32_t node) const {
    return {children_.data() + first_child_[node], first_child_[node + 1] - first_child_[node]};
  }
  bool operator==(const ObjectTree&) const = default;

 private:
  std::uint32_t object_count_ = 0;
  std::vector<std::uint32_t> parent_of_node_, object_of_node_;
  std::vector<std::uint32_t> first_child_ = {0}, children_;
};

/// The matrix with one column for each node: a node is visible where an object below it is, so the result is monotone
/// over the tree. Requires tree.object_count() == objects.shape().columns. O(ones * depth).
VisibilityMatrix nodes_from_objects(const VisibilityMatrix& objects, const ObjectTree& tree);

/// Whether the matrix is monotone: every node's column includes the columns of its children. Needs columns ==
/// tree.size().
bool is_monotone(const VisibilityMatrix& nodes, const ObjectTree& tree);

/// The smallest box around the objects of each node; [0, 0] if a node has none. `of_objects` has a box for each object.
std::vector<Box> node_bounds(const ObjectTree& tree, std::span<const Box> of_objects);

}  // namespace vismat
