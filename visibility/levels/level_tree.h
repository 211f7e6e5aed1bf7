// Makes a hierarchy over a level's objects of the level's own BSP tree.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "matrix/object_tree.h"
#include "matrix/visibility_matrix.h"

namespace vismat {

/// A node's two children, front first: node number where >= 0, else leaf -(child + 1).
using BspChildren = std::array<std::int32_t, 2>;

struct BspItem {
  std::int32_t child;    // a node or a leaf, as above
  std::uint32_t parent;  // its place in the walk; ObjectTree::none for the root
};
/// All that `root` leads to, parents first, each front side before the back. Throws FormatError, beginning
/// with `lump_name`, for a child that does not exist and for one reached twice (a cycle). O(nodes), without
/// recursion.
std::vector<BspItem> walk_bsp(std::span<const BspChildren> nodes, std::uint32_t root,
                              std::uint32_t leaf_count, const std::string& lump_name);

/// The walk as a tree over the columns of `objects_of_leaf` (one row a leaf). Branches without objects (solid
/// leafs) are pruned, a node left with one child gives way to it, and a branch that holds one object alone
/// becomes a leaf of it; an object may still be in several leafs. A leaf of several objects becomes a node
/// over them; an object under no leaf of the walk hangs on the root, so that every one is in the tree.
ObjectTree level_tree(std::span<const BspItem> walk, const VisibilityMatrix& objects_of_leaf);

}  // namespace vismat
