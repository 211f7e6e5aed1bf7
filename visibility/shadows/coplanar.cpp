#include "visibility/shadows/coplanar.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numeric>

namespace vismat {

std::vector<CoplanarFace> coplanar_faces(const Mesh& mesh, std::span<const MeshSide> sides,
                                         double tolerance) {
  const auto count = static_cast<std::uint32_t>(mesh.triangles.size());
  const std::vector<std::array<Neighbour, 3>> neighbours = neighbours_of(mesh, sides);
  std::vector<glm::dvec3> normals(count);  // as long as twice the area
  for (std::uint32_t t = 0; t < count; ++t) {
    const std::array<std::uint32_t, 3>& corners = mesh.triangles[t];
    normals[t] = glm::cross(mesh.vertices[corners[1]] - mesh.vertices[corners[0]],
                            mesh.vertices[corners[2]] - mesh.vertices[corners[0]]);
  }
  std::vector<std::uint32_t> seeds(count);
  std::iota(seeds.begin(), seeds.end(), 0u);
  std::stable_sort(seeds.begin(), seeds.end(), [&](std::uint32_t a, std::uint32_t b) {
    return glm::dot(normals[a], normals[a]) > glm::dot(normals[b], normals[b]);
  });

  std::vector<CoplanarFace> faces;
  std::vector<std::uint32_t> face_of(count, Neighbour::none);
  std::vector<bool> turned(count);
  for (const std::uint32_t seed : seeds) {
    if (face_of[seed] != Neighbour::none) continue;
    CoplanarFace face;
    const auto number = static_cast<std::uint32_t>(faces.size());
    const double length = glm::length(normals[seed]);
    const glm::dvec3 up = length > 0 ? normals[seed] / length : glm::dvec3{};
    const glm::dvec3 origin = mesh.vertices[mesh.triangles[seed][0]];
    face_of[seed] = number;
    face.triangles = {seed};
    glm::dvec3 sum{};
    for (std::size_t next = 0; next < face.triangles.size(); ++next) {
      const std::uint32_t t = face.triangles[next];
      sum += turned[t] ? -normals[t] : normals[t];
      for (const Neighbour& neighbour : neighbours[t]) {
        if (length == 0 || neighbour.triangle == Neighbour::none ||
            face_of[neighbour.triangle] != Neighbour::none)
          continue;
        const bool turn = turned[t] != neighbour.turned;
        const glm::dvec3& normal = normals[neighbour.triangle];
        if (glm::dot(turn ? -normal : normal, up) < 0) continue;  // folded back
        const auto& corners = mesh.triangles[neighbour.triangle];
        if (std::all_of(corners.begin(), corners.end(), [&](std::uint32_t corner) {
              return std::abs(glm::dot(up, mesh.vertices[corner] - origin)) <= tolerance;
            })) {
          face_of[neighbour.triangle] = number;
          turned[neighbour.triangle] = turn;
          face.triangles.push_back(neighbour.triangle);
        }
      }
    }
    face.area = glm::length(sum) / 2;
    if (face.area > 0) {
      face.normal = glm::normalize(sum);
      double low = std::numeric_limits<double>::infinity(), high = -low;
      for (const std::uint32_t t : face.triangles) {
        for (const std::uint32_t corner : mesh.triangles[t]) {
          const double at = glm::dot(face.normal, mesh.vertices[corner]);
          low = std::min(low, at), high = std::max(high, at);
        }
      }
      face.offset = low + (high - low) / 2;
      face.deviation = (high - low) / 2;
    }
    for (const std::uint32_t t : face.triangles) {
      for (unsigned i = 0; i < 3; ++i) {
        const Neighbour& neighbour = neighbours[t][i];
        const bool inner = neighbour.triangle != Neighbour::none && face_of[neighbour.triangle] == number &&
                           (turned[t] != neighbour.turned) == turned[neighbour.triangle];
        if (inner) continue;
        const std::uint32_t from = mesh.triangles[t][i], to = mesh.triangles[t][(i + 1) % 3];
        face.outline.push_back(turned[t] ? std::array{to, from} : std::array{from, to});
      }
    }
    faces.push_back(std::move(face));
  }
  return faces;
}

}  // namespace vismat
