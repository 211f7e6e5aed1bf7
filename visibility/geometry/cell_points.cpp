#include "visibility/geometry/cell_points.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <utility>

namespace vismat {
namespace {

std::size_t drawn(const std::vector<double>& up_to, Random& random) {
  const auto place = std::upper_bound(up_to.begin(), up_to.end(), random.fraction() * up_to.back());
  return static_cast<std::size_t>(std::min(place, up_to.end() - 1) - up_to.begin());
}

}  // namespace

CellPoints::CellPoints(Convex cell) : cell_(std::move(cell)) {
  for (const glm::dvec3& vertex : cell_.vertices)
    centre_ += vertex / static_cast<double>(cell_.vertices.size());
  double area = 0, length = 0;
  for (const Convex::Face& face : cell_.faces) {
    for (std::size_t i = 1; i + 1 < face.corners.size(); ++i) {
      triangles_.push_back({face.corners[0], face.corners[i], face.corners[i + 1]});
      const glm::dvec3& a = cell_.vertices[face.corners[0]];
      area += glm::length(
          glm::cross(cell_.vertices[face.corners[i]] - a, cell_.vertices[face.corners[i + 1]] - a));
      area_up_to_.push_back(area);
    }
  }
  for (const Convex::Edge& edge : cell_.edges) {
    length += glm::distance(cell_.vertices[edge.ends[0]], cell_.vertices[edge.ends[1]]);
    length_up_to_.push_back(length);
  }
}

bool CellPoints::contains(const glm::vec3& point) const {
  return std::all_of(cell_.faces.begin(), cell_.faces.end(), [&](const Convex::Face& face) {
    return glm::dot(face.normal, glm::dvec3(point)) <= face.offset;
  });
}

glm::vec3 CellPoints::within(const glm::dvec3& point) const {
  const glm::vec3 nearest(point);
  if (contains(nearest)) return nearest;
  for (double pull = 0x1p-22; pull <= 0x1p-4; pull *= 4) {
    const glm::vec3 pulled(point + (centre_ - point) * pull);
    if (contains(pulled)) return pulled;
  }
  return nearest;
}

glm::vec3 CellPoints::on_edge(Random& random) const {
  const Convex::Edge& edge = cell_.edges[drawn(length_up_to_, random)];
  return within(glm::mix(cell_.vertices[edge.ends[0]], cell_.vertices[edge.ends[1]], random.fraction()));
}

glm::vec3 CellPoints::on_face(Random& random) const {
  if (!(area_up_to_.back() > 0)) return on_edge(random);
  const auto [a, b, c] = triangles_[drawn(area_up_to_, random)];
  double u = random.fraction(), v = random.fraction();
  if (u + v > 1) u = 1 - u, v = 1 - v;
  const glm::dvec3& origin = cell_.vertices[a];
  return within(origin + (cell_.vertices[b] - origin) * u + (cell_.vertices[c] - origin) * v);
}

std::optional<std::array<double, 2>> CellPoints::part_of(const glm::dvec3& from, const glm::dvec3& direction,
                                                         double limit) const {
  double first = 0, last = limit;
  for (const Convex::Face& face : cell_.faces) {
    const double outside = glm::dot(face.normal, from) - face.offset,
                 speed = glm::dot(face.normal, direction);
    if (speed == 0) {
      if (outside > 0) return {};
    } else if (speed < 0) {
      first = std::max(first, outside / -speed);
    } else {
      last = std::min(last, -outside / speed);
    }
  }
  if (!(first <= last)) return {};
  return std::array{first, last};
}

std::optional<glm::vec3> CellPoints::common_point(const std::array<glm::vec3, 3>& triangle) const {
  std::vector<glm::dvec3> polygon(triangle.begin(), triangle.end()), clipped;
  for (const Convex::Face& face : cell_.faces) {
    clipped.clear();
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const glm::dvec3 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
      const double at_a = glm::dot(face.normal, a) - face.offset,
                   at_b = glm::dot(face.normal, b) - face.offset;
      if (at_a <= 0) clipped.push_back(a);
      if ((at_a < 0 && at_b > 0) || (at_a > 0 && at_b < 0))
        clipped.push_back(a + (b - a) * (at_a / (at_a - at_b)));
    }
    if (clipped.empty()) return {};
    std::swap(polygon, clipped);
  }
  glm::dvec3 sum{};
  for (const glm::dvec3& corner : polygon) sum += corner;
  return within(sum / static_cast<double>(polygon.size()));
}

}  // namespace vismat
