// The triangles of one object at one level of detail, as a chunk of a store.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "visibility/detail/levels_of_detail.h"
#include "visibility/geometry/mesh.h"

namespace vismat {

struct LevelGeometry {
  std::vector<glm::vec3> vertices;                      // metres; only those that triangles use
  std::vector<std::array<std::uint32_t, 3>> triangles;  // each corner < vertices.size()
  bool operator==(const LevelGeometry&) const = default;
};

/// The level's triangles, with vertices numbered in the order of their first use.
LevelGeometry geometry_of(const Mesh& mesh, const LevelOfDetail& level);

/// The bytes of a chunk, little-endian: the numbers of vertices and of triangles, 4 bytes each; 3 floats for each
/// vertex; 3 corners for each triangle, of 2 bytes if there are at most 65,536 vertices, otherwise of 4.
std::vector<std::byte> to_chunk(const LevelGeometry& geometry);
/// Throws FormatError on bytes that to_chunk cannot have made.
LevelGeometry geometry_from_chunk(std::span<const std::byte> chunk);

}  // namespace vismat
