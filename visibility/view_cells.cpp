#include "visibility/view_cells.h"

#include <algorithm>
#include <array>

namespace vismat {

std::vector<Box> cell_bounds(const ViewCells& cells) {
  std::vector<Box> bounds(cells.count());
  for (std::uint32_t cell = 0; cell < cells.prisms(); ++cell) {
    const glm::vec3* corner = &cells.corners[std::size_t{3} * cell];
    for (int axis = 0; axis < 3; ++axis) {
      const auto [low, high] = std::minmax({corner[0][axis], corner[1][axis], corner[2][axis]});
      bounds[cell].low[axis] = low + (axis == 2 ? cells.eye_low : 0);
      bounds[cell].high[axis] = high + (axis == 2 ? cells.eye_high : 0);
    }
  }
  std::copy(cells.boxes.begin(), cells.boxes.end(), bounds.begin() + cells.prisms());
  return bounds;
}

Convex convex_of(const ViewCells& cells, std::uint32_t cell) {
  if (cell >= cells.prisms()) return convex_box(cells.boxes[cell - cells.prisms()]);
  const glm::vec3* corner = &cells.corners[std::size_t{3} * cell];
  return convex_prism({corner[0], corner[1], corner[2]}, cells.eye_low, cells.eye_high);
}

}  // namespace vismat
