#include "visibility/levels/level_places.h"

#include <algorithm>
#include <glm/geometric.hpp>

namespace vismat {

std::vector<Stay> stays_along(const LevelPlaces& places, const glm::dvec3& from, const glm::dvec3& to) {
  struct Part {
    std::int32_t child;
    double from, to;
  };
  std::vector<Part> open = {{0, 0, 1}};  // the nearest last
  std::vector<Stay> stays;
  while (!open.empty()) {
    const Part part = open.back();
    open.pop_back();
    if (part.child < 0) {
      const std::int32_t cell = places.cell_of_leaf[static_cast<std::size_t>(~part.child)];
      if (!stays.empty() && stays.back().cell == cell) {
        stays.back().to = part.to;
      } else {
        stays.push_back({cell, part.from, part.to});
      }
      continue;
    }
    const LevelPlaces::Node& node = places.nodes[static_cast<std::size_t>(part.child)];
    const LevelPlaces::Plane& plane = places.planes[node.plane];
    const glm::dvec3 normal(plane.normal);
    const double at_0 = glm::dot(normal, from) - plane.distance, at_1 = glm::dot(normal, to) - plane.distance;
    const double at_from = at_0 + part.from * (at_1 - at_0), at_to = at_0 + part.to * (at_1 - at_0);
    const auto side = [](double at) { return at >= 0 ? 0 : 1; };
    if (side(at_from) == side(at_to)) {
      open.push_back({node.children[side(at_from)], part.from, part.to});
      continue;
    }
    const double cut = std::clamp(at_0 / (at_0 - at_1), part.from, part.to);
    open.push_back({node.children[side(at_to)], cut, part.to});
    open.push_back({node.children[side(at_from)], part.from, cut});
  }
  return stays;
}

std::int32_t cell_at(const LevelPlaces& places, const glm::dvec3& point) {
  return stays_along(places, point, point).front().cell;
}

bool has_point_in_cell(const LevelPlaces& places, const Box& box) {
  constexpr unsigned points = 6;
  const glm::dvec3 low(box.low[0], box.low[1], box.low[2]), high(box.high[0], box.high[1], box.high[2]);
  for (unsigned i = 0; i < points * points * points; ++i) {
    const glm::dvec3 at(i % points, i / points % points, i / (points * points));
    if (cell_at(places, low + (high - low) * ((at + 0.5) / double{points})) >= 0) return true;
  }
  return false;
}

}  // namespace vismat
