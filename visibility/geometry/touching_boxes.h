// Finds which boxes touch, which gives the neighbours of view cells whose boxes alone are known.
#pragma once
#include <span>

#include "matrix/box.h"
#include "matrix/visibility_matrix.h"

namespace vismat {

/// A symmetric matrix of boxes x boxes; no box is its own neighbour. Two boxes touch if they have part of a face in
/// common, not only part of an edge or a corner; for grids and octrees this is exact. Boxes that overlap, as those
/// around cells of other shapes do, touch too. Flat boxes in one plane touch along part of an edge; a box without any
/// extent has no neighbours. Coordinates are compared as they are, without a tolerance. Sorts and sweeps along the axis
/// on which the fewest pairs overlap: O(boxes log boxes + such pairs); a grid of n cells has n^(5/3) of them.
VisibilityMatrix touching_boxes(std::span<const Box> boxes);

}  // namespace vismat
