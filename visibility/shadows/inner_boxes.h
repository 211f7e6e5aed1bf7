// Finds the largest axis-aligned boxes inside a closed surface.
#pragma once
#include <vector>

#include "visibility/geometry/mesh.h"
#include "visibility/geometry/point_bounds.h"

namespace vismat {

/// At most `most` axis-aligned boxes that no triangle enters and around whose middle the surface winds, so that they
/// lie inside it. The surface must be closed, see winding_number. They are chosen one after another, the largest
/// silhouette first, each weighted by the part of it that no earlier box holds; boxes whose second longest side is
/// shorter than `smallest` are left out. Walls that are parallel to the axes, up to `tolerance`, are reached exactly;
/// towards other walls the boxes end on a grid of 1/12 of the extent. Deterministic. O(triangles) and some 10^5 steps
/// for each box.
std::vector<Bounds> inner_boxes(const Mesh& mesh, unsigned most, double smallest, double tolerance);

}  // namespace vismat
