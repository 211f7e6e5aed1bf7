// Finds the ground that a viewer can walk to.
#pragma once
#include <cstdint>
#include <vector>

#include "visibility/cells/ground_cells.h"
#include "visibility/cells/ground_triangles.h"
#include "visibility/scene.h"

namespace vismat {

/// Of each triangle those over whose edges one walks onto it: they overlap in the plan, no more than a step apart in height.
/// Symmetric, ascending.
std::vector<std::vector<std::uint32_t>> walkable_neighbours(const std::vector<Triangle>& triangles,
                                                            double step);

/// 1 for each triangle that can be walked to from where the viewers start, or where they start nowhere, for the largest part
/// of the ground that is under the sky. Throws std::invalid_argument where a start has no ground below it.
std::vector<std::uint8_t> reached_on_foot(const Scene& scene, const std::vector<Triangle>& triangles,
                                          const std::vector<std::vector<std::uint32_t>>& neighbours,
                                          const GroundCellsOptions& options);

}  // namespace vismat
