// Builds a hierarchy over any set of boxes, by median splits.
#pragma once
#include <span>

#include "matrix/box.h"
#include "matrix/object_tree.h"

namespace vismat {

/// Object i is boxes[i]; each is in one leaf, each leaf holds one. Every inner node has exactly `arity`
/// children (4: as the quadtree of Zach and Karner 2003), but for at most one that has fewer. Nodes are numbered breadth
/// first. Depends on the boxes alone: equal centres are told apart by their index. O(n log^2 n). Throws
/// std::invalid_argument for an arity below 2 or a box that is not finite.
ObjectTree bounding_volume_tree(std::span<const Box> boxes, unsigned arity = 4);

}  // namespace vismat
