// Triangles that belong to objects.
#pragma once
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "matrix/dataset.h"

namespace vismat {

/// Metres, right-handed, z up.
struct Scene {
  std::vector<glm::vec3> vertices;
  std::vector<std::uint32_t> indices;             // 3 per triangle, each < vertices.size()
  std::vector<std::uint32_t> object_of_triangle;  // each < object_count: the matrix's columns
  std::uint32_t object_count = 0;
  std::vector<std::uint8_t>
      see_through;  // one an object, 1 for glass and grates, which hide nothing; empty: none is
};

/// One box an object; an object without triangles gets the empty box [0, 0].
std::vector<Box> object_bounds(const Scene& scene);

}  // namespace vismat
