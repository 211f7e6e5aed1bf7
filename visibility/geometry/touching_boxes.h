// Finds which boxes touch, and so the neighbours of view cells that are known by their boxes alone.
#pragma once
#include <span>

#include "matrix/box.h"
#include "matrix/visibility_matrix.h"

namespace vismat {

/// Boxes x boxes, symmetric, no box its own neighbour. Two touch where they have part of a face in common, not just an edge
/// or a corner: exact for grids and octrees. Boxes that overlap, as those around cells of other shapes do, touch too. Flat
/// boxes in the same plane touch along part of an edge; a box without any extent has no neighbours. Coordinates are
/// compared as they are, without a tolerance. Sorts and sweeps along the axis on which the fewest pairs overlap:
/// O(boxes log boxes + such pairs); a grid of n cells has n^(5/3) of them.
VisibilityMatrix touching_boxes(std::span<const Box> boxes);

}  // namespace vismat
