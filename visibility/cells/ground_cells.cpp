// ALGORITHM. Each piece of ground (level triangles of one height that meet, or one sloping triangle) is a polygon in
// the plan. Whatever of the scene lies within a viewer's height above it is clipped to that band, laid into the plan,
// grown by the radius and taken away; a wall, which has no area in the plan, becomes a strip, so that inside and
// outside of a closed building fall apart and nothing need be known of which side of a triangle is solid. What rises no
// higher than a step and is walkable is taken away without growing: a viewer stands on it instead. The rest is
// triangulated (constrained Delaunay). Pieces join where their edges overlap in the plan, no more than a step apart;
// walking over such edges from the start finds what is kept. Obstacles grow to the convex hull of squares at their
// corners, which keeps right angles: round ones cost many triangles.
#include "visibility/cells/ground_cells.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <map>
#include <numbers>
#include <numeric>
#include <span>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>

#include "matrix/base/parallel.h"
#include "matrix/base/union_find.h"
#include "matrix/base/z_order.h"
#include "visibility/cells/ground_triangles.h"
#include "visibility/cells/ground_walk.h"
#include "visibility/cells/plan_bins.h"
#include "visibility/geometry/plane_geometry.h"

namespace vismat {
namespace {

[[noreturn]] void refuse(const std::string& what) {
  throw std::invalid_argument("ground cells: " + what);
}

using Corners = std::array<glm::dvec3, 3>;

struct Plane {  // z = at.z + slope.(xy - at.xy)
  glm::dvec3 at{};
  glm::dvec2 slope{};
  double height(double x, double y) const { return at.z + slope.x * (x - at.x) + slope.y * (y - at.y); }
};

/// Ground of one slope and height.
struct Piece {
  Plane plane;
  std::vector<std::uint32_t> triangles;  // of the scene
  Box bounds;
};

struct Surface {
  const Scene& scene;
  std::vector<std::uint8_t> walkable;  // of triangles
  Corners corners(std::uint32_t triangle) const { return corners_of<glm::dvec3>(scene, triangle); }
};

Box bounds_of(const Corners& corners) {
  Box box = empty_box;
  for (const glm::dvec3& corner : corners) grow(box, glm::vec3(corner));
  return box;
}

/// The part of the triangle between two heights above the plane, as a convex polygon in the plan.
std::vector<glm::dvec2> within_band(const Corners& triangle, const Plane& plane, double low, double high) {
  std::vector<glm::dvec3> polygon;  // z: above the plane
  for (const glm::dvec3& c : triangle) polygon.emplace_back(c.x, c.y, c.z - plane.height(c.x, c.y));
  for (const double sign : {1.0, -1.0}) {
    const double bound = sign > 0 ? low : -high;
    std::vector<glm::dvec3> kept;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const glm::dvec3 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
      const double above_a = sign * a.z - bound, above_b = sign * b.z - bound;
      if (above_a >= 0) kept.push_back(a);
      if ((above_a > 0 && above_b < 0) || (above_a < 0 && above_b > 0)) {
        kept.push_back(a + (b - a) * (above_a / (above_a - above_b)));
      }
    }
    polygon = std::move(kept);
  }
  std::vector<glm::dvec2> plan;
  for (const glm::dvec3& c : polygon) plan.emplace_back(c.x, c.y);
  return plan;
}

/// The convex hull of squares at the corners.
Polygon grown(const Polygon& polygon, double radius) {
  Polygon corners;
  for (const glm::dvec2& c : polygon) {
    for (const double x : {-radius, radius})
      for (const double y : {-radius, radius}) corners.push_back(c + glm::dvec2(x, y));
  }
  return hull_in_plan(std::move(corners));
}

/// What is left of a piece, at its height.
std::vector<Triangle> free_of_obstacles(const Surface& surface, const PlanBins& bins, const Piece& piece,
                                        const GroundCellsOptions& options) {
  const double low = 1e-3, high = double{(*options.viewers.eyes)[1]} + options.radius;
  GroundPlan plan;
  for (const std::uint32_t triangle : piece.triangles) {
    Polygon corners;
    for (const glm::dvec3& c : surface.corners(triangle)) corners.emplace_back(c.x, c.y);
    corners = hull_in_plan(std::move(corners));
    if (corners.size() >= 3) plan.ground.push_back(std::move(corners));
  }
  if (piece.triangles.empty()) {  // a plane over the region
    const Box& b = piece.bounds;
    plan.ground.push_back(
        {{b.low[0], b.low[1]}, {b.high[0], b.low[1]}, {b.high[0], b.high[1]}, {b.low[0], b.high[1]}});
  }
  Box around = piece.bounds;
  for (unsigned axis = 0; axis < 2; ++axis) {
    around.low[axis] -= options.radius;
    around.high[axis] += options.radius;
  }
  around.high[2] += static_cast<float>(high);
  for (const std::uint32_t triangle : bins.meeting(around)) {
    const Corners corners = surface.corners(triangle);
    if (surface.walkable[triangle]) {
      auto step = hull_in_plan(within_band(corners, piece.plane, low, options.step));
      if (step.size() >= 3) plan.steps.push_back(std::move(step));
    }
    const auto obstacle = within_band(corners, piece.plane, options.step, high);
    if (!obstacle.empty()) plan.obstacles.push_back(grown(obstacle, options.radius));
  }
  // A flat wall of many triangles leaves corners on straight edges; a quarter of the radius is given away for fewer.
  std::vector<Triangle> triangles = triangulate(plan, options.radius / 4);
  for (Triangle& t : triangles) {
    for (glm::vec3& corner : t) corner.z = static_cast<float>(piece.plane.height(corner.x, corner.y));
  }
  std::erase_if(triangles, [](const Triangle& t) {
    const glm::dvec2 a(t[0]), b(t[1]), c(t[2]);
    const double longest = std::max({glm::distance(a, b), glm::distance(b, c), glm::distance(c, a)});
    return !(cross(b - a, c - a) > plan_grid * longest);
  });
  return triangles;
}

/// Triangles in groups, so that boxes of different groups do not meet in the plan.
std::vector<std::vector<std::uint32_t>> touching_in_plan(std::vector<std::uint32_t>& triangles,
                                                         const std::vector<Box>& boxes) {
  std::sort(triangles.begin(), triangles.end(), [&](std::uint32_t a, std::uint32_t b) {
    return std::pair(boxes[a].low[0], a) < std::pair(boxes[b].low[0], b);
  });
  const auto count = static_cast<std::uint32_t>(triangles.size());
  UnionFind joined(count);  // a group's root is its first member
  for (std::uint32_t i = 0; i < count; ++i) {
    const Box& a = boxes[triangles[i]];
    for (std::uint32_t j = i + 1; j < count && boxes[triangles[j]].low[0] <= a.high[0]; ++j) {
      const Box& b = boxes[triangles[j]];
      if (!(a.low[1] > b.high[1] || b.low[1] > a.high[1])) joined.join_sets(i, j);
    }
  }
  std::vector<std::vector<std::uint32_t>> groups(count);
  for (std::uint32_t i = 0; i < count; ++i) groups[joined.find(i)].push_back(triangles[i]);
  std::erase_if(groups, [](const auto& some) { return some.empty(); });
  return groups;
}

std::vector<Piece> pieces_of(const Surface& surface, const std::vector<Box>& boxes, const Box& region,
                             const GroundCellsOptions& options) {
  std::vector<Piece> pieces;
  if (options.height) {
    Piece& plane = pieces.emplace_back();
    plane.plane.at.z = *options.height;
    plane.bounds = region;
    plane.bounds.low[2] = plane.bounds.high[2] = *options.height;
    return pieces;
  }
  std::map<float, std::vector<std::uint32_t>> of_height;  // level triangles, for joining
  const auto add_piece = [&](std::span<const std::uint32_t> triangles, const glm::dvec2& slope) {
    Piece& piece = pieces.emplace_back();
    piece.plane = {surface.corners(triangles[0])[0], slope};
    piece.triangles.assign(triangles.begin(), triangles.end());
    piece.bounds = boxes[triangles[0]];
    for (const std::uint32_t triangle : triangles) {
      for (unsigned axis = 0; axis < 2; ++axis) {
        piece.bounds.low[axis] = std::min(piece.bounds.low[axis], boxes[triangle].low[axis]);
        piece.bounds.high[axis] = std::max(piece.bounds.high[axis], boxes[triangle].high[axis]);
      }
    }
  };
  for (std::uint32_t triangle = 0; triangle < boxes.size(); ++triangle) {
    const Box& box = boxes[triangle];
    if (!surface.walkable[triangle]) continue;
    bool inside = true;
    for (unsigned axis = 0; axis < 3; ++axis) {
      inside &= box.low[axis] >= region.low[axis] && box.high[axis] <= region.high[axis];
    }
    if (!inside) continue;
    if (box.low[2] == box.high[2]) {
      of_height[box.low[2]].push_back(triangle);
    } else {
      const Corners c = surface.corners(triangle);
      const glm::dvec3 normal = glm::cross(c[1] - c[0], c[2] - c[0]);
      add_piece(std::span(&triangle, 1), glm::dvec2(-normal.x, -normal.y) / normal.z);
    }
  }
  for (auto& [height, triangles] : of_height) {
    for (const auto& together : touching_in_plan(triangles, boxes)) add_piece(together, {});
  }
  std::erase_if(pieces, [&](const Piece& piece) {
    double area = 0;
    for (const std::uint32_t triangle : piece.triangles) area += area_in_plan(surface.corners(triangle));
    return area < options.smallest;
  });
  return pieces;
}

void check(const GroundCellsOptions& o) {
  if (!(o.steepest >= 0 && o.steepest < 89)) refuse("the steepest slope must lie between 0 and 89 degrees");
  if (!(o.step > 0.01f && o.step <= 100)) refuse("a step must be 0.01 to 100 m high");
  if (!(o.radius >= 0.01f && o.radius <= 100)) refuse("the radius must lie between 0.01 and 100 m");
  if (!(o.smallest >= 0)) refuse("the smallest area must not be below 0");
  if (!o.viewers.eyes) refuse("viewers on the ground need eye heights");
  const auto [low, high] = *o.viewers.eyes;
  if (!(low >= o.step && low <= high && high <= 1000)) {
    refuse("eyes must be at least a step and at most 1000 m above the ground, the lower height first");
  }
  if (o.height && !(std::abs(*o.height) <= 1e9f)) refuse("the ground's height must lie within 1e9 m");
}

}  // namespace

ViewCells make_ground_cells(const Scene& scene, const GroundCellsOptions& options) {
  check(options);
  const Box region = options.region ? *options.region : bounds_of(scene);
  const auto count = static_cast<std::uint32_t>(scene.indices.size() / 3);
  Surface surface{scene, std::vector<std::uint8_t>(count)};
  std::vector<Box> boxes(count);
  const double upright = std::cos(options.steepest * std::numbers::pi / 180);
  for (std::uint32_t triangle = 0; triangle < count; ++triangle) {
    const Corners c = surface.corners(triangle);
    const glm::dvec3 normal = glm::cross(c[1] - c[0], c[2] - c[0]);
    boxes[triangle] = bounds_of(c);
    surface.walkable[triangle] =
        std::abs(normal.z) > 0 && std::abs(normal.z) >= upright * glm::length(normal);
  }
  const PlanBins bins(boxes, region);
  const std::vector<Piece> pieces = pieces_of(surface, boxes, region, options);
  std::vector<std::vector<Triangle>> of_piece(pieces.size());
  parallel_for(pieces.size(), options.threads,
               [&](std::uint64_t i) { of_piece[i] = free_of_obstacles(surface, bins, pieces[i], options); });
  std::vector<Triangle> triangles;
  for (const auto& some : of_piece) triangles.insert(triangles.end(), some.begin(), some.end());
  if (triangles.empty())
    refuse("no ground in the region that one can stand on; give a height, or a larger region");

  const double side = std::max({region.high[0] - region.low[0], region.high[1] - region.low[1], 1e-3f});
  const auto key = [&](const Triangle& t) {
    const glm::vec3 centroid = (t[0] + t[1] + t[2]) / 3.0f;
    const auto square = [&](double x) {
      return static_cast<std::uint32_t>(std::clamp(x / side, 0.0, 1.0) * 4095);
    };
    return std::tuple(
        z_order(square(double{centroid.x} - region.low[0]), square(double{centroid.y} - region.low[1])),
        centroid.z, centroid.x, centroid.y);
  };
  std::sort(triangles.begin(), triangles.end(),
            [&](const Triangle& a, const Triangle& b) { return key(a) < key(b); });
  const auto neighbours = walkable_neighbours(triangles, options.step);
  const std::vector<std::uint8_t> reached = reached_on_foot(scene, triangles, neighbours, options);

  ViewCells cells;
  cells.eye_low = (*options.viewers.eyes)[0];
  cells.eye_high = (*options.viewers.eyes)[1];
  std::vector<std::uint32_t> kept(triangles.size());  // the cell of each triangle
  std::inclusive_scan(reached.begin(), reached.end(), kept.begin(), std::plus<>(), 0u);
  std::vector<std::vector<std::uint32_t>> rows;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    if (!reached[i]) continue;
    cells.corners.insert(cells.corners.end(), triangles[i].begin(), triangles[i].end());
    rows.push_back(neighbours[i]);
    for (std::uint32_t& other : rows.back()) other = kept[other] - 1;
  }
  cells.neighbours = VisibilityMatrix::from_rows(rows, static_cast<std::uint32_t>(rows.size()));
  return cells;
}

}  // namespace vismat
