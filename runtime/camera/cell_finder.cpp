#include "runtime/camera/cell_finder.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "visibility/geometry/bounding_volume_tree.h"
#include "visibility/geometry/convex.h"
#include "visibility/geometry/point_bounds.h"

namespace vismat {
namespace {

/// The box in floats that holds all that is within the rounding of the cell's vertices.
Box box_outside(const Convex& cell) {
  Box box;
  const Bounds bounds = bounds_of(cell.vertices);
  constexpr float infinity = std::numeric_limits<float>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    const auto index = static_cast<std::size_t>(axis);
    box.low[index] = std::nextafter(static_cast<float>(bounds.low[axis] - CellFinder::rounding), -infinity);
    box.high[index] = std::nextafter(static_cast<float>(bounds.high[axis] + CellFinder::rounding), infinity);
  }
  return box;
}

bool in_box(const Box& box, const glm::dvec3& point, double tolerance) {
  for (int axis = 0; axis < 3; ++axis) {
    const auto index = static_cast<std::size_t>(axis);
    if (!(point[axis] - box.low[index] >= -tolerance && box.high[index] - point[axis] >= -tolerance))
      return false;
  }
  return true;
}

}  // namespace

CellFinder::CellFinder(const ViewCells& cells) : prisms_(cells.prisms()), boxes_(cells.boxes) {
  std::vector<Box> around;
  for (std::uint32_t cell = 0; cell < cells.count(); ++cell) {
    const Convex convex = convex_of(cells, cell);
    around.push_back(box_outside(convex));
    if (cell >= prisms_.size()) continue;
    for (std::size_t face = 0; face < prisms_[cell].size(); ++face)
      prisms_[cell][face] = {convex.faces[face].normal, convex.faces[face].offset};
  }
  if (around.empty()) return;
  tree_ = bounding_volume_tree(around);
  around_node_ = node_bounds(tree_, around);
}

bool CellFinder::holds(std::uint32_t cell, const glm::dvec3& point, double tolerance) const {
  if (cell >= prisms_.size()) return in_box(boxes_[cell - prisms_.size()], point, tolerance);
  return std::ranges::all_of(prisms_[cell], [&](const Plane& plane) {
    return glm::dot(plane.normal, point) - plane.offset <= tolerance;
  });
}

std::uint32_t CellFinder::find(const glm::dvec3& point, std::uint32_t previous) const {
  if (previous < prisms_.size() + boxes_.size() && holds(previous, point)) return previous;
  std::uint32_t exact = none, near = none;
  std::vector<std::uint32_t> nodes;
  if (tree_.size() > 0) nodes.push_back(0);
  while (!nodes.empty()) {
    const std::uint32_t node = nodes.back(), cell = tree_.object_of_node()[node];
    nodes.pop_back();
    if (!in_box(around_node_[node], point, 0)) continue;
    for (const std::uint32_t child : tree_.children(node)) nodes.push_back(child);
    if (cell == ObjectTree::none || !holds(cell, point, rounding)) continue;
    if (near == none || near != previous) near = cell == previous ? cell : std::min(near, cell);
    if (holds(cell, point)) exact = std::min(exact, cell);
  }
  return exact != none ? exact : near;
}

std::vector<std::uint32_t> cells_along(const CellFinder& finder, std::span<const Pose> poses) {
  std::vector<std::uint32_t> cells;
  cells.reserve(poses.size());
  for (const Pose& pose : poses)
    cells.push_back(finder.find(pose.position, cells.empty() ? CellFinder::none : cells.back()));
  return cells;
}

}  // namespace vismat
