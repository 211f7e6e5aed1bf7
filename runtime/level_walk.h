// A viewer's walk from view cell to view cell, through a level or a city.
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "matrix/box.h"
#include "matrix/visibility_matrix.h"
#include "visibility/levels/level.h"

namespace vismat {

/// The cells of a level between which a viewer may walk: two that touch and see one another. A symmetric matrix of
/// cells x cells.
VisibilityMatrix passages_of(const Level& level);

/// The largest connected part of the cells (the first of equally large ones), in breadth-first order from its
/// lowest-numbered cell. O(passages).
std::vector<std::uint32_t> largest_part(const VisibilityMatrix& passages);

/// The cells after `from` on the shortest way to `goal`, which must be reachable. Lengths are measured between the
/// cells' centres.
std::vector<std::uint32_t> shortest_way(const VisibilityMatrix& passages, std::span<const Box> cells,
                                        std::uint32_t from, std::uint32_t goal);

/// The first cell of a walk and `steps` more, each of which is reached by a passage from the one before. The viewer
/// walks to random cells of the largest connected part, one after another, each time by the shortest way. `cells` has a
/// box for each cell. The same seed gives the same walk. Throws std::invalid_argument if there is no passage between
/// any two cells.
std::vector<std::uint32_t> walk_cells(const VisibilityMatrix& passages, std::span<const Box> cells,
                                      std::uint32_t steps, std::uint64_t seed);

}  // namespace vismat
