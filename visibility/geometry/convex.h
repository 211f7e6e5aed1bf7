// Convex solids and flat convex polygons: the shapes of view cells and occluders.
#pragma once
#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "matrix/box.h"

namespace vismat {

/// A closed convex polytope; a flat one has faces back to back. The faces' planes and the edges' two faces alone decide
/// on which side of a face a point lies and which edges are seen as the outline, so flat polytopes need no special
/// case.
struct Convex {
  struct Face {
    glm::dvec3 normal{};                 // unit length, outward
    double offset = 0;                   // inside: dot(normal, x) <= offset
    std::vector<std::uint16_t> corners;  // counter-clockwise, seen from outside
  };
  struct Edge {
    std::array<std::uint16_t, 2> ends{}, faces{};  // ends in the order in which faces[0] has them
  };
  std::vector<glm::dvec3> vertices;
  std::vector<Face> faces;
  std::vector<Edge> edges;
};

/// The box as a solid: 8 vertices, 6 faces, 12 edges, however flat it is.
Convex convex_box(const Box& box);
/// The same for a turned box: bits 1, 2 and 4 of a corner's number say whether it is at the high x, y and z of the
/// box's own frame.
Convex convex_turned_box(std::vector<glm::dvec3> corners);
/// The prism over the triangle `ground`, from `low` to `high` above it: 6 vertices, 5 faces, 9 edges. The triangle may
/// slope.
Convex convex_prism(const std::array<glm::vec3, 3>& ground, float low, float high);
/// A flat convex polygon with two faces, from its corners in order. `normal` belongs to the side from which they run
/// counter-clockwise.
Convex convex_polygon(std::span<const glm::dvec3> corners, const glm::dvec3& normal);
/// The same polygon as a view cell: a plate without thickness whose rim has faces of its own, so that what stands beside it
/// sees an outline too.
Convex convex_plate(std::span<const glm::dvec3> corners, const glm::dvec3& normal);
/// The solid with these vertices and faces, whose corners run counter-clockwise seen from outside. Planes are Newell's,
/// moved outward until no vertex lies beyond them. Throws std::invalid_argument unless each edge has two faces that run
/// along it in opposite directions.
Convex convex_from_faces(std::vector<glm::dvec3> vertices,
                         std::vector<std::vector<std::uint16_t>> corners_of_face);

/// The largest signed distance of a vertex from the plane dot(normal, x) = offset.
double farthest_beyond(std::span<const glm::dvec3> vertices, const glm::dvec3& normal, double offset);

}  // namespace vismat
