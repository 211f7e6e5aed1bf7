// Builds a tree over any set of boxes, by median splits.
#pragma once
#include <span>

#include "matrix/box.h"
#include "matrix/object_tree.h"

namespace vismat {

/// The tree of bounding boxes. Object i is boxes[i]; each object is in one leaf, and each leaf holds one object. Every
/// inner node has exactly `arity` children (4: as the quadtree of Zach and Karner 2003), except that at most one may
/// have fewer. Nodes are numbered breadth first. The tree depends only on the boxes: equal centres are told apart by
/// their index. O(n log^2 n). Throws std::invalid_argument for an arity below 2 or a box that is not finite.
ObjectTree bounding_volume_tree(std::span<const Box> boxes, unsigned arity = 4);

}  // namespace vismat
