// A mesh of triangles that share vertices: one object of a scene, or a part of one.
#pragma once
#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "visibility/geometry/point_bounds.h"

namespace vismat {

struct Mesh {
  std::vector<glm::dvec3> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// A side of a triangle, between two vertices with the lower number first.
struct MeshSide {
  std::array<std::uint32_t, 2> ends{};
  std::uint32_t triangle = 0;
  bool forward = false;  // whether the triangle runs along it from ends[0] to ends[1]
};

/// The mesh of the given triangles of `indices`, which has 3 for each. Vertices that are equal bit for bit (-0 is 0)
/// are joined, and triangles that have a vertex twice are left out. O(n log n).
Mesh mesh_of(std::span<const glm::vec3> vertices, std::span<const std::uint32_t> indices,
             std::span<const std::uint32_t> triangles);

/// All sides, ascending by their ends, so that the sides that triangles share are neighbours. O(n log n).
std::vector<MeshSide> sides_of(const Mesh& mesh);

/// For each triangle the number of its connected part: triangles that share a side are in one part. Parts are numbered
/// from 0, in the order of their first triangles.
std::vector<std::uint32_t> parts_by_sides(const Mesh& mesh, std::span<const MeshSide> sides);

struct Neighbour {
  static constexpr std::uint32_t none = 0xffffffff;
  std::uint32_t triangle = none;
  bool turned = false;  // it runs along the common side in the same direction
};
/// For each triangle its neighbours across its sides, which run from corner i to the next; `none` if the side does not
/// have exactly two triangles.
std::vector<std::array<Neighbour, 3>> neighbours_of(const Mesh& mesh, std::span<const MeshSide> sides);

/// Turns triangles so that two which share a side that no third one has run along it in opposite directions, as the
/// first triangle of each part does. This makes the surfaces of solids closed; a Moebius strip stays as it is
/// somewhere. `sides` are those of the mesh before. O(triangles).
void orient(Mesh& mesh, std::span<const MeshSide> sides);

/// How often the surface winds around the point. For a closed surface (along each of whose sides as many triangles run
/// forward as backward) this is a whole number that changes only across triangles and is 0 far away. Computed from
/// solid angles [van Oosterom and Strackee 1983], so the point may be anywhere. O(triangles).
int winding_number(const Mesh& mesh, const glm::dvec3& point);

/// Whether a triangle has a point in the open box. Near misses past the box's edges count as hits, triangles in the
/// planes of its faces do not. By separating axes. O(triangles).
bool enters_box(const Mesh& mesh, const Bounds& box);
/// The same for one triangle.
bool enters_box(const std::array<glm::dvec3, 3>& triangle, const Bounds& box);

}  // namespace vismat
