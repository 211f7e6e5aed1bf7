// Triangulates the ground, by constrained Delaunay triangulation of polygons in the xy-plane, and finds which triangles touch.
#pragma once
#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "matrix/box.h"

namespace vismat {

using Triangle = std::array<glm::vec3, 3>;
using Polygon = std::vector<glm::dvec2>;  // its corners in order

/// In metres: corners in the plan are rounded to multiples of it, and thinner triangles are left out.
constexpr double plan_grid = 1e-3;

/// The convex hull of the points, counter-clockwise from its least (x, y); fewer than three corners if it has no area.
Polygon hull_in_plan(Polygon points);
double area_in_plan(const std::array<glm::dvec3, 3>& triangle);

/// Convex polygons in the plan, which may overlap.
struct GroundPlan {
  std::vector<Polygon> ground, obstacles, steps;
};

/// Triangles that cover the ground without its obstacles, whose outlines may move by `tolerance` to save corners, and
/// without its steps. They lie at height 0, each counter-clockwise from the corner of least (x, y). GEOS promises no
/// order of them. Throws std::runtime_error with GEOS's message if it fails.
std::vector<Triangle> triangulate(const GroundPlan& plan, double tolerance);
/// The same for a rectangle without holes that lie apart from one another and from its border.
std::vector<Triangle> triangulate_around(const Box& ground, std::span<const Box> holes);

/// For each triangle, the triangles that share an edge with it, corner for corner.
std::vector<std::vector<std::uint32_t>> edge_neighbours(std::span<const Triangle> triangles);

}  // namespace vismat
