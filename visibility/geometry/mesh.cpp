#include "visibility/geometry/mesh.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <numbers>
#include <tuple>

#include "matrix/base/union_find.h"

namespace vismat {

Mesh mesh_of(std::span<const glm::vec3> vertices, std::span<const std::uint32_t> indices,
             std::span<const std::uint32_t> triangles) {
  using Point = std::array<float, 3>;
  const auto point_of = [&](std::uint32_t triangle, unsigned corner) {
    const glm::vec3& at = vertices[indices[3 * std::size_t{triangle} + corner]];
    return Point{at.x + 0.f, at.y + 0.f, at.z + 0.f};  // -0 + 0 is 0
  };
  std::vector<Point> points;
  points.reserve(3 * triangles.size());
  for (const std::uint32_t triangle : triangles) {
    for (unsigned corner = 0; corner < 3; ++corner) points.push_back(point_of(triangle, corner));
  }
  std::sort(points.begin(), points.end());
  points.erase(std::unique(points.begin(), points.end()), points.end());

  Mesh mesh;
  for (const Point& p : points) mesh.vertices.emplace_back(p[0], p[1], p[2]);
  for (const std::uint32_t triangle : triangles) {
    std::array<std::uint32_t, 3> corners{};
    for (unsigned corner = 0; corner < 3; ++corner) {
      const auto at = std::lower_bound(points.begin(), points.end(), point_of(triangle, corner));
      corners[corner] = static_cast<std::uint32_t>(at - points.begin());
    }
    if (corners[0] != corners[1] && corners[1] != corners[2] && corners[2] != corners[0]) {
      mesh.triangles.push_back(corners);
    }
  }
  return mesh;
}

std::vector<MeshSide> sides_of(const Mesh& mesh) {
  std::vector<MeshSide> sides;
  sides.reserve(3 * mesh.triangles.size());
  for (std::uint32_t triangle = 0; triangle < mesh.triangles.size(); ++triangle) {
    for (unsigned i = 0; i < 3; ++i) {
      const std::uint32_t from = mesh.triangles[triangle][i], to = mesh.triangles[triangle][(i + 1) % 3];
      sides.push_back({{std::min(from, to), std::max(from, to)}, triangle, from < to});
    }
  }
  std::sort(sides.begin(), sides.end(), [](const MeshSide& a, const MeshSide& b) {
    return std::tie(a.ends, a.triangle) < std::tie(b.ends, b.triangle);
  });
  return sides;
}

std::vector<std::uint32_t> parts_by_sides(const Mesh& mesh, std::span<const MeshSide> sides) {
  UnionFind joined(static_cast<std::uint32_t>(mesh.triangles.size()));  // a part's root is its first triangle
  for (std::size_t i = 1; i < sides.size(); ++i) {
    if (sides[i].ends == sides[i - 1].ends) joined.join_sets(sides[i].triangle, sides[i - 1].triangle);
  }
  std::vector<std::uint32_t> parts(mesh.triangles.size());
  std::uint32_t count = 0;
  for (std::uint32_t triangle = 0; triangle < parts.size(); ++triangle) {
    const std::uint32_t first = joined.find(triangle);
    parts[triangle] = first == triangle ? count++ : parts[first];
  }
  return parts;
}

std::vector<std::array<Neighbour, 3>> neighbours_of(const Mesh& mesh, std::span<const MeshSide> sides) {
  std::vector<std::array<Neighbour, 3>> neighbours(mesh.triangles.size());
  const auto set = [&](const MeshSide& side, const MeshSide& other) {
    const std::array<std::uint32_t, 3>& corners = mesh.triangles[side.triangle];
    for (unsigned i = 0; i < 3; ++i) {
      if (corners[i] == side.ends[side.forward ? 0 : 1] &&
          corners[(i + 1) % 3] == side.ends[side.forward ? 1 : 0]) {
        neighbours[side.triangle][i] = {other.triangle, side.forward == other.forward};
      }
    }
  };
  for (std::size_t i = 0; i < sides.size();) {
    std::size_t end = i + 1;
    while (end < sides.size() && sides[end].ends == sides[i].ends) ++end;
    if (end - i == 2) set(sides[i], sides[i + 1]), set(sides[i + 1], sides[i]);
    i = end;
  }
  return neighbours;
}

void orient(Mesh& mesh, std::span<const MeshSide> sides) {
  const std::vector<std::array<Neighbour, 3>> neighbours = neighbours_of(mesh, sides);
  enum : std::uint8_t { open, kept, turned };
  std::vector<std::uint8_t> state(mesh.triangles.size(), open);
  std::vector<std::uint32_t> next;
  for (std::uint32_t first = 0; first < state.size(); ++first) {
    if (state[first] != open) continue;
    state[first] = kept;
    next = {first};
    while (!next.empty()) {
      const std::uint32_t t = next.back();
      next.pop_back();
      for (const Neighbour& neighbour : neighbours[t]) {
        if (neighbour.triangle == Neighbour::none || state[neighbour.triangle] != open) continue;
        state[neighbour.triangle] = (state[t] == turned) == neighbour.turned ? kept : turned;
        next.push_back(neighbour.triangle);
      }
    }
  }
  for (std::size_t t = 0; t < state.size(); ++t) {
    if (state[t] == turned) std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
  }
}

int winding_number(const Mesh& mesh, const glm::dvec3& point) {
  double halves = 0;  // of solid angles
  for (const std::array<std::uint32_t, 3>& corners : mesh.triangles) {
    const glm::dvec3 a = mesh.vertices[corners[0]] - point, b = mesh.vertices[corners[1]] - point,
                     c = mesh.vertices[corners[2]] - point;
    const double la = glm::length(a), lb = glm::length(b), lc = glm::length(c);
    halves += std::atan2(glm::dot(a, glm::cross(b, c)),
                         la * lb * lc + glm::dot(a, b) * lc + glm::dot(b, c) * la + glm::dot(c, a) * lb);
  }
  return static_cast<int>(std::lround(halves / (2 * std::numbers::pi)));
}

bool enters_box(const std::array<glm::dvec3, 3>& triangle, const Bounds& box) {
  const auto& [low, high] = box;
  const Bounds around = bounds_of(triangle);
  for (int i = 0; i < 3; ++i) {
    if (around.high[i] <= low[i] || around.low[i] >= high[i]) return false;
  }
  const glm::dvec3 centre = (low + high) / 2.0, half = (high - low) / 2.0;
  const std::array<glm::dvec3, 3> at = {triangle[0] - centre, triangle[1] - centre, triangle[2] - centre};
  const auto apart = [&](const glm::dvec3& axis) {
    const double a = glm::dot(axis, at[0]), b = glm::dot(axis, at[1]), c = glm::dot(axis, at[2]);
    const double reach = glm::dot(glm::abs(axis), half);
    const double slack = 1e-12 * (reach + std::abs(a) + std::abs(b) + std::abs(c));
    return std::min({a, b, c}) > reach + slack || std::max({a, b, c}) < -reach - slack;
  };
  const std::array<glm::dvec3, 3> along = {at[1] - at[0], at[2] - at[1], at[0] - at[2]};
  if (apart(glm::cross(along[0], along[1]))) return false;
  for (const glm::dvec3& e : along) {
    if (apart({0, e.z, -e.y}) || apart({-e.z, 0, e.x}) || apart({e.y, -e.x, 0})) return false;
  }
  return true;
}

bool enters_box(const Mesh& mesh, const Bounds& box) {
  return std::any_of(mesh.triangles.begin(), mesh.triangles.end(), [&](const auto& corners) {
    return enters_box({mesh.vertices[corners[0]], mesh.vertices[corners[1]], mesh.vertices[corners[2]]}, box);
  });
}

}  // namespace vismat
