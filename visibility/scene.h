// A scene: triangles, each of which belongs to an object.
#pragma once
#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <string>
#include <vector>

#include "matrix/dataset.h"

namespace vismat {

/// Triangles and the objects that they belong to; in metres, right-handed, z up.
struct Scene {
  std::vector<glm::vec3> vertices;
  std::vector<std::uint32_t> indices;             // 3 per triangle, each < vertices.size()
  std::vector<std::uint32_t> object_of_triangle;  // each < object_count: the matrix's columns
  std::uint32_t object_count = 0;
  /// For each object 1 if it hides nothing, such as glass and grates, otherwise 0; empty if all are opaque.
  std::vector<std::uint8_t> see_through;
  /// For each object its name, in UTF-8; empty if objects have none.
  std::vector<std::string> object_names;
};

template <typename Point = glm::vec3>
std::array<Point, 3> corners_of(const Scene& scene, std::size_t triangle) {
  std::array<Point, 3> corners;
  for (std::size_t i = 0; i < 3; ++i) corners[i] = scene.vertices[scene.indices[3 * triangle + i]];
  return corners;
}

/// One box for each object; an object without triangles gets the box [0, 0].
std::vector<Box> object_bounds(const Scene& scene);

/// The smallest box around the vertices that triangles use. Throws std::invalid_argument if there is no triangle.
Box bounds_of(const Scene& scene);

/// The triangles of each object.
class ObjectTriangles {
 public:
  explicit ObjectTriangles(const Scene& scene);  // O(triangles)
  /// The numbers of the object's triangles, ascending; borrowed.
  std::span<const std::uint32_t> of(std::uint32_t object) const {
    return std::span(triangles_).subspan(first_[object], first_[object + 1] - first_[object]);
  }

 private:
  std::vector<std::uint64_t> first_;  // where each object's triangles begin, and the end
  std::vector<std::uint32_t> triangles_;
};

}  // namespace vismat
