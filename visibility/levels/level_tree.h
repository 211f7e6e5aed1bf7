// Turns a level's own BSP tree into a tree over its objects.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "matrix/object_tree.h"
#include "matrix/visibility_matrix.h"

namespace vismat {

/// A node's two children, front first: a node's number if >= 0, otherwise leaf -(child + 1).
using BspChildren = std::array<std::int32_t, 2>;

struct BspItem {
  std::int32_t child;    // a node or a leaf, as above
  std::uint32_t parent;  // its place in the walk; ObjectTree::none for the root
};
/// All nodes and leaves below `root`, parents first, each front side before the back. Throws FormatError, beginning
/// with `lump_name`, for a child that does not exist and for one that is reached twice (a cycle). O(nodes), without
/// recursion.
std::vector<BspItem> walk_bsp(std::span<const BspChildren> nodes, std::uint32_t root,
                              std::uint32_t leaf_count, const std::string& lump_name);

/// The walk as a tree over the columns of `objects_of_leaf`, which has a row for each leaf. Branches without objects
/// (solid leaves) are removed, a node that is left with one child is replaced by it, and a branch that holds only one
/// object becomes a leaf with it; an object may still be in several leaves. A leaf with several objects becomes a node
/// over them. An object under no leaf of the walk becomes a child of the root, so that the tree holds every object.
ObjectTree level_tree(std::span<const BspItem> walk, const VisibilityMatrix& objects_of_leaf);

}  // namespace vismat
