#include "visibility/scene.h"

#include <algorithm>
#include <limits>

namespace vismat {

std::vector<Box> object_bounds(const Scene& scene) {
  constexpr float infinity = std::numeric_limits<float>::infinity();
  std::vector<Box> bounds(scene.object_count,
                          {{infinity, infinity, infinity}, {-infinity, -infinity, -infinity}});
  for (std::size_t i = 0; i < scene.indices.size(); ++i) {
    const glm::vec3& vertex = scene.vertices[scene.indices[i]];
    Box& box = bounds[scene.object_of_triangle[i / 3]];
    for (int axis = 0; axis < 3; ++axis) {
      box.low[axis] = std::min(box.low[axis], vertex[axis]);
      box.high[axis] = std::max(box.high[axis], vertex[axis]);
    }
  }
  for (Box& box : bounds) {
    if (box.low[0] > box.high[0]) box = {};
  }
  return bounds;
}

}  // namespace vismat
