#include "visibility/cells/ground_walk.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include "matrix/base/union_find.h"
#include "visibility/geometry/plane_geometry.h"
#include "visibility/rays/ray_caster.h"

namespace vismat {
namespace {

/// The triangle on which one stands who falls from the point; none: its number is that of all triangles.
std::size_t below(const std::vector<Triangle>& triangles, const glm::vec3& point) {
  std::size_t best = triangles.size();
  double highest = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const Triangle& t = triangles[i];
    const glm::dvec2 p(point);
    std::array<double, 3> weight;
    for (unsigned side = 0; side < 3; ++side) {
      const glm::dvec2 a(t[(side + 1) % 3]), b(t[(side + 2) % 3]);
      weight[side] = cross(b - a, p - a);
    }
    if (*std::min_element(weight.begin(), weight.end()) < 0) continue;
    const double sum = weight[0] + weight[1] + weight[2];
    const double height = (weight[0] * t[0].z + weight[1] * t[1].z + weight[2] * t[2].z) / sum;
    if (height <= point.z && height > highest) highest = height, best = i;
  }
  return best;
}

}  // namespace

std::vector<std::vector<std::uint32_t>> walkable_neighbours(const std::vector<Triangle>& triangles,
                                                            double step) {
  std::vector<std::vector<std::uint32_t>> rows = edge_neighbours(triangles);
  struct Edge {
    glm::dvec3 a, b;
    std::uint32_t triangle;
    double low, high;  // along x
  };
  std::vector<Edge> edges;
  for (std::uint32_t i = 0; i < triangles.size(); ++i) {
    for (unsigned side = 0; side < 3; ++side) {
      const glm::vec3 a = triangles[i][side], b = triangles[i][(side + 1) % 3];
      const bool shared = std::any_of(rows[i].begin(), rows[i].end(), [&](std::uint32_t other) {
        const Triangle& t = triangles[other];
        return std::count(t.begin(), t.end(), a) == 1 && std::count(t.begin(), t.end(), b) == 1;
      });
      if (!shared)
        edges.push_back({a, b, i, std::min(a.x, b.x) - 2 * plan_grid, std::max(a.x, b.x) + 2 * plan_grid});
    }
  }
  std::stable_sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) { return a.low < b.low; });
  const auto meet = [&](const Edge& e, const Edge& f) {
    const glm::dvec2 from(e.a), along = glm::dvec2(e.b) - from;
    const double length = glm::length(along);
    if (!(length > 0)) return false;
    const glm::dvec2 unit = along / length;
    const auto place = [&](const glm::dvec3& p) {
      return glm::dvec2(glm::dot(unit, glm::dvec2(p) - from), cross(unit, glm::dvec2(p) - from));
    };
    const glm::dvec2 c = place(f.a), d = place(f.b);
    if (!(d.x < c.x) || std::abs(c.y) > 2 * plan_grid || std::abs(d.y) > 2 * plan_grid) return false;
    const double begin = std::max(0.0, d.x), end = std::min(length, c.x);
    if (end - begin < 10 * plan_grid) return false;
    const double middle = (begin + end) / 2;
    const double height_e = e.a.z + (e.b.z - e.a.z) * middle / length;
    const double height_f = f.a.z + (f.b.z - f.a.z) * (c.x - middle) / (c.x - d.x);
    return std::abs(height_e - height_f) <= step;
  };
  for (std::size_t i = 0; i < edges.size(); ++i) {
    for (std::size_t j = i + 1; j < edges.size() && edges[j].low <= edges[i].high; ++j) {
      const std::uint32_t a = edges[i].triangle, b = edges[j].triangle;
      if (a == b || !meet(edges[i], edges[j])) continue;
      rows[a].push_back(b);
      rows[b].push_back(a);
    }
  }
  for (auto& row : rows) {
    std::sort(row.begin(), row.end());
    row.erase(std::unique(row.begin(), row.end()), row.end());
  }
  return rows;
}

std::vector<std::uint8_t> reached_on_foot(const Scene& scene, const std::vector<Triangle>& triangles,
                                          const std::vector<std::vector<std::uint32_t>>& neighbours,
                                          const GroundCellsOptions& options) {
  const auto count = static_cast<std::uint32_t>(triangles.size());
  UnionFind connected(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    for (const std::uint32_t next : neighbours[i]) connected.join_sets(i, next);
  }
  std::vector<std::uint32_t> part(triangles.size());  // connected ground, by its first triangle
  for (std::uint32_t i = 0; i < count; ++i) part[i] = connected.find(i);
  std::vector<std::uint8_t> start(triangles.size());  // of parts
  for (const glm::vec3& from : options.viewers.from) {
    const std::size_t triangle = below(triangles, from);
    if (triangle == triangles.size()) {
      throw std::invalid_argument("ground cells: no ground that one can stand on below the start (" +
                                  std::to_string(from.x) + ", " + std::to_string(from.y) + ", " +
                                  std::to_string(from.z) + ")");
    }
    start[part[triangle]] = 1;
  }
  if (options.viewers.from.empty()) {
    const RayCaster caster(scene);
    std::vector<double> area(triangles.size());
    std::vector<std::uint8_t> under_sky(triangles.size());
    for (std::size_t i = 0; i < triangles.size(); ++i) {
      const Triangle& t = triangles[i];
      area[part[i]] += area_in_plan({t[0], t[1], t[2]});
      if (under_sky[part[i]]) continue;
      glm::vec3 eye = (t[0] + t[1] + t[2]) / 3.0f;
      eye.z += (*options.viewers.eyes)[0];
      under_sky[part[i]] = caster.hit(eye, {0, 0, 1}).triangle == Hit::nothing;
    }
    std::uint32_t best = 0;
    for (std::uint32_t i = 1; i < count; ++i) {
      if (std::pair(under_sky[i], area[i]) > std::pair(under_sky[best], area[best])) best = i;
    }
    start[best] = 1;
  }
  std::vector<std::uint8_t> reached(triangles.size());
  for (std::size_t i = 0; i < triangles.size(); ++i) reached[i] = start[part[i]];
  return reached;
}

}  // namespace vismat
