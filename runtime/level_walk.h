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

/// From which cell of a level one may go on to which: they touch, and see one another. Cells x cells, symmetric.
VisibilityMatrix passages_of(const Level& level);

/// The greatest part of the cells that passages join, the first of equal ones, breadth first from its least cell. O(passages).
std::vector<std::uint32_t> largest_part(const VisibilityMatrix& passages);

/// The cells after `from` on the shortest way to `goal`, measured between the cells' centres. Some way must lead there.
std::vector<std::uint32_t> shortest_way(const VisibilityMatrix& passages, std::span<const Box> cells,
                                        std::uint32_t from, std::uint32_t goal);

/// The cell in which the walk begins and `steps` more, each reached by a passage from the one before. The viewer goes to a cell
/// drawn at random by the shortest way, then to the next: straight on, as somebody who knows the place, over all of its
/// largest part. `cells` has a box for each. The same seed gives the same walk. Throws std::invalid_argument where no passage
/// leads from any cell to another.
std::vector<std::uint32_t> walk_cells(const VisibilityMatrix& passages, std::span<const Box> cells,
                                      std::uint32_t steps, std::uint64_t seed);

}  // namespace vismat
