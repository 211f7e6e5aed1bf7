// Finds the largest axis-aligned boxes inside of a closed surface.
#pragma once
#include <vector>

#include "visibility/geometry/bounds.h"
#include "visibility/geometry/mesh.h"

namespace vismat {

/// Axis-aligned boxes, at most `most`, that no triangle enters and round whose middle the surface winds: they lie inside of
/// it. The surface must be closed, see winding_number. Chosen one after the other, the largest silhouette first, each
/// weighed by what of it no earlier box holds; those whose second longest side is shorter than `smallest` are left out.
/// Walls that are parallel to the axes, up to `tolerance`, are reached exactly; towards others the boxes end on a grid of
/// 1/12 of the extent. Deterministic. O(triangles) and some 10^5 steps a box.
std::vector<Bounds> inner_boxes(const Mesh& mesh, unsigned most, double smallest, double tolerance);

}  // namespace vismat
