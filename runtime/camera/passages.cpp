#include "runtime/camera/passages.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <span>
#include <utility>
#include <vector>

#include "visibility/geometry/convex.h"
#include "visibility/geometry/plane_geometry.h"
#include "visibility/geometry/point_bounds.h"
#include "visibility/geometry/touching_boxes.h"

namespace vismat {
namespace {

constexpr double touching = 1e-7;  // metres; less than CellFinder::rounding
constexpr double beside = 2e-3;    // of sides in the plan, whose corners are rounded to millimetres

/// The part of the polygon within `touching` of the solid.
std::vector<glm::dvec3> clipped(std::vector<glm::dvec3> polygon, const Convex& solid) {
  for (const Convex::Face& face : solid.faces) {
    std::vector<glm::dvec3> kept;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const glm::dvec3 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
      const double beyond_a = glm::dot(face.normal, a) - face.offset;
      const double beyond_b = glm::dot(face.normal, b) - face.offset;
      if (beyond_a <= touching) kept.push_back(a);
      if ((beyond_a <= touching) != (beyond_b <= touching))
        kept.push_back(a + (b - a) * std::clamp(beyond_a / (beyond_a - beyond_b), 0., 1.));
    }
    polygon = std::move(kept);
  }
  return polygon;
}

/// The middle of what two solids share, whose vertices lie on faces of the one or the other.
std::optional<glm::dvec3> middle_of_common(const Convex& a, const Convex& b) {
  std::vector<glm::dvec3> common;
  for (const auto& [solid, other] : {std::pair(&a, &b), std::pair(&b, &a)}) {
    for (const Convex::Face& face : solid->faces) {
      std::vector<glm::dvec3> polygon;
      for (const std::uint16_t corner : face.corners) polygon.push_back(solid->vertices[corner]);
      polygon = clipped(std::move(polygon), *other);
      common.insert(common.end(), polygon.begin(), polygon.end());
    }
  }
  if (common.empty()) return {};
  return middle_of(common);
}

std::optional<glm::dvec3> middle_of_common(const Box& a, const Box& b) {
  glm::dvec3 middle;
  for (unsigned axis = 0; axis < 3; ++axis) {
    const double low = std::max(a.low[axis], b.low[axis]), high = std::min(a.high[axis], b.high[axis]);
    if (low > high) return {};
    middle[static_cast<int>(axis)] = (low + high) / 2;
  }
  return middle;
}

/// Across the sides of two prisms that lie along one another for the longest way.
std::optional<Passage> passage_of_sides(const ViewCells& cells, std::uint32_t a, std::uint32_t b) {
  double longest = 0;
  Passage on_ground;
  for (std::size_t i = 0; i < 3; ++i) {
    const glm::dvec3 from = cells.corners[3 * std::size_t{a} + i];
    const glm::dvec3 side = glm::dvec3(cells.corners[3 * std::size_t{a} + (i + 1) % 3]) - from;
    const double length = glm::length(glm::dvec2(side));
    if (!(length > 0)) continue;
    const glm::dvec2 along = glm::dvec2(side) / length;
    const auto place = [&](const glm::dvec3& point) {
      const glm::dvec2 offset(point - from);
      return glm::dvec2(glm::dot(along, offset), cross(along, offset));
    };
    for (std::size_t j = 0; j < 3; ++j) {
      glm::dvec3 begin = cells.corners[3 * std::size_t{b} + j];
      glm::dvec3 end = cells.corners[3 * std::size_t{b} + (j + 1) % 3];
      if (place(begin).x > place(end).x) std::swap(begin, end);
      const glm::dvec2 first = place(begin), last = place(end);
      if (std::max(std::abs(first.y), std::abs(last.y)) > beside) continue;
      const double low = std::max(0., first.x), high = std::min(length, last.x), middle = (low + high) / 2;
      if (!(high - low > longest)) continue;
      longest = high - low;
      on_ground = {from + side * (middle / length),
                   begin + (end - begin) * ((middle - first.x) / (last.x - first.x))};
    }
  }
  if (longest == 0) return {};
  // Eyes at a height that both have, or as near to it as they come.
  const double eye_low = cells.eye_low, eye_high = cells.eye_high;
  double &za = on_ground.leaves.z, &zb = on_ground.enters.z;
  const double low = std::max(za, zb) + eye_low, high = std::min(za, zb) + eye_high;
  if (low <= high) {
    za = zb = (low + high) / 2;
  } else {
    const bool up = za < zb;
    za += up ? eye_high : eye_low;
    zb += up ? eye_low : eye_high;
  }
  if (glm::distance(on_ground.leaves, on_ground.enters) <= touching)
    on_ground.enters = on_ground.leaves = (on_ground.leaves + on_ground.enters) / 2.;
  return on_ground;
}

std::optional<Passage> passage_upwards(const ViewCells& cells, std::uint32_t a, std::uint32_t b) {
  if (b < cells.prisms()) {
    if (const auto passage = passage_of_sides(cells, a, b)) return passage;
  }
  const auto middle = a >= cells.prisms()
                          ? middle_of_common(cells.boxes[a - cells.prisms()], cells.boxes[b - cells.prisms()])
                          : middle_of_common(convex_of(cells, a), convex_of(cells, b));
  if (!middle) return {};
  return Passage{*middle, *middle};
}

}  // namespace

std::optional<Passage> passage_between(const ViewCells& cells, std::uint32_t from, std::uint32_t to) {
  std::optional<Passage> passage = passage_upwards(cells, std::min(from, to), std::max(from, to));
  if (passage && from > to) std::swap(passage->leaves, passage->enters);
  return passage;
}

VisibilityMatrix cell_neighbours(const ViewCells& cells) {
  return cells.neighbours ? *cells.neighbours : touching_boxes(cell_bounds(cells));
}

VisibilityMatrix passages_of(const ViewCells& cells) {
  const VisibilityMatrix neighbours = cell_neighbours(cells);
  std::vector<std::vector<std::uint32_t>> passages(cells.count());
  for (std::uint32_t a = 0; a < cells.count(); ++a) {
    for (const std::uint32_t b : neighbours.row(a)) {
      if (b <= a) continue;
      const auto passage = passage_between(cells, a, b);
      if (!passage || (!cells.neighbours && glm::distance(passage->leaves, passage->enters) > beside))
        continue;
      passages[a].push_back(b);
      passages[b].push_back(a);
    }
  }
  for (auto& row : passages) std::ranges::sort(row);
  return VisibilityMatrix::from_rows(passages, cells.count());
}

}  // namespace vismat
