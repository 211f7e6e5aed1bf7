// Finds the ground that a viewer can walk to.
#pragma once
#include <cstdint>
#include <vector>

#include "visibility/cells/ground_cells.h"
#include "visibility/cells/ground_triangles.h"
#include "visibility/scene.h"

namespace vismat {

/// For each triangle, the triangles from which one can step onto it: they overlap in the plan, no more than a step
/// apart in height. Symmetric; each list ascends.
std::vector<std::vector<std::uint32_t>> walkable_neighbours(const std::vector<Triangle>& triangles,
                                                            double step);

/// For each triangle 1 if it can be walked to from where the viewers start or, if no start is given, from the largest
/// part of the ground that is under the sky; otherwise 0. Throws std::invalid_argument if a start has no ground below
/// it.
std::vector<std::uint8_t> reached_on_foot(const Scene& scene, const std::vector<Triangle>& triangles,
                                          const std::vector<std::vector<std::uint32_t>>& neighbours,
                                          const GroundCellsOptions& options);

}  // namespace vismat
