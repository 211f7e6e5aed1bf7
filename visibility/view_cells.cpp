#include "visibility/view_cells.h"

#include <algorithm>

namespace vismat {

std::vector<Box> cell_bounds(const ViewCells& cells) {
  std::vector<Box> bounds(cells.count());
  for (std::uint32_t cell = 0; cell < cells.prisms(); ++cell) {
    Box& box = bounds[cell] = empty_box;
    for (std::size_t i = 0; i < 3; ++i) grow(box, cells.corners[3 * std::size_t{cell} + i]);
    box.low[2] += cells.eye_low;
    box.high[2] += cells.eye_high;
  }
  std::copy(cells.boxes.begin(), cells.boxes.end(), bounds.begin() + cells.prisms());
  return bounds;
}

ViewCells resized(const ViewCells& cells, float factor) {
  ViewCells result = cells;
  result.neighbours.reset();
  const auto resize = [factor](float& low, float& high) {
    const float middle = low / 2 + high / 2, half = (high / 2 - low / 2) * factor;
    low = middle - half;
    high = middle + half;
  };
  for (std::size_t first = 0; first < result.corners.size(); first += 3) {
    glm::vec3* corner = &result.corners[first];
    const glm::vec3 middle = corner[0] / 3.0f + corner[1] / 3.0f + corner[2] / 3.0f;
    for (int i = 0; i < 3; ++i) corner[i] = middle + (corner[i] - middle) * factor;
  }
  resize(result.eye_low, result.eye_high);
  for (Box& box : result.boxes) {
    for (unsigned axis = 0; axis < 3; ++axis) resize(box.low[axis], box.high[axis]);
  }
  return result;
}

Convex convex_of(const ViewCells& cells, std::uint32_t cell) {
  if (cell >= cells.prisms()) return convex_box(cells.boxes[cell - cells.prisms()]);
  const glm::vec3* corner = &cells.corners[std::size_t{3} * cell];
  return convex_prism({corner[0], corner[1], corner[2]}, cells.eye_low, cells.eye_high);
}

}  // namespace vismat
