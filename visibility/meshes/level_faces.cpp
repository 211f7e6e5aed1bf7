#include "visibility/meshes/level_faces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <map>
#include <utility>

namespace vismat {

int axis_of_level_faces(const Scene& scene) {
  constexpr double level = 0.999;  // 2.6 degrees
  glm::dvec3 seen_along(0);
  double area = 0;
  glm::dvec3 low(1e30), high(-1e30);
  for (const glm::vec3& vertex : scene.vertices)
    low = glm::min(low, glm::dvec3(vertex)), high = glm::max(high, glm::dvec3(vertex));
  const double extent = std::max({high.x - low.x, high.y - low.y, high.z - low.z, 1e-9});
  std::map<std::pair<int, long>, double> planes;
  for (std::size_t t = 0; t < scene.object_of_triangle.size(); ++t) {
    const auto c = corners_of<glm::dvec3>(scene, t);
    const glm::dvec3 normal = glm::abs(glm::cross(c[1] - c[0], c[2] - c[0])) / 2.0;
    const double size = glm::length(normal);
    seen_along += normal, area += size;
    for (int axis = 0; axis < 3; ++axis) {
      if (normal[axis] < level * size || size == 0) continue;
      planes[{axis, std::lround((c[0][axis] - low[axis]) / extent * 10000)}] += size;
    }
  }
  glm::dvec3 largest(0);
  for (const auto& [plane, size] : planes) largest[plane.first] = std::max(largest[plane.first], size);
  const bool has_planes = std::max({largest.x, largest.y, largest.z}) >= area / 20;
  const glm::dvec3& of_axis = has_planes ? largest : seen_along;
  const int other = of_axis.x > of_axis.y ? 0 : 1;
  return of_axis[other] > 2 * of_axis.z ? other : 2;
}

}  // namespace vismat
