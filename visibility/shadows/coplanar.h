// Finds the flat faces of a mesh: sets of connected triangles in one plane.
#pragma once
#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "visibility/geometry/mesh.h"

namespace vismat {

/// A flat face. Its surface, seen along the normal, has no fold, and no edges except `outline`.
struct CoplanarFace {
  std::vector<std::uint32_t> triangles;
  std::vector<std::array<std::uint32_t, 2>>
      outline;           // directed: counter-clockwise round the face, clockwise round holes
  glm::dvec3 normal{};   // unit length; zero if the face has no area
  double offset = 0;     // of the plane dot(normal, x) = offset, midway
  double deviation = 0;  // no vertex lies farther from that plane
  double area = 0;
};

/// Divides the mesh into faces; each triangle is in one. A face grows from the largest triangle that is left, across
/// sides with exactly two triangles, as long as corners lie within `tolerance` of that triangle's plane; triangles that
/// run along a side in the same direction are turned over. Deterministic. O(n log n).
std::vector<CoplanarFace> coplanar_faces(const Mesh& mesh, std::span<const MeshSide> sides, double tolerance);

}  // namespace vismat
