#include "visibility/scene.h"

#include <numeric>
#include <stdexcept>

namespace vismat {

std::vector<Box> object_bounds(const Scene& scene) {
  std::vector<Box> bounds(scene.object_count, empty_box);
  for (std::size_t i = 0; i < scene.indices.size(); ++i) {
    grow(bounds[scene.object_of_triangle[i / 3]], scene.vertices[scene.indices[i]]);
  }
  for (Box& box : bounds) box = zero_if_empty(box);
  return bounds;
}

Box bounds_of(const Scene& scene) {
  if (scene.indices.empty())
    throw std::invalid_argument("the scene has no triangle, so its bounds are unknown");
  Box bounds = empty_box;
  for (const std::uint32_t vertex : scene.indices) grow(bounds, scene.vertices[vertex]);
  return bounds;
}

ObjectTriangles::ObjectTriangles(const Scene& scene)
    : first_(std::size_t{scene.object_count} + 1), triangles_(scene.object_of_triangle.size()) {
  for (const std::uint32_t object : scene.object_of_triangle) ++first_[object + 1];
  std::partial_sum(first_.begin(), first_.end(), first_.begin());
  std::vector<std::uint64_t> next(first_.begin(), first_.end() - 1);
  for (std::uint32_t t = 0; t < triangles_.size(); ++t) triangles_[next[scene.object_of_triangle[t]]++] = t;
}

}  // namespace vismat
