#include "visibility/geometry/convex.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <limits>
#include <map>
#include <stdexcept>
#include <utility>

namespace vismat {
namespace {

using Corners = std::vector<std::uint16_t>;

// The corners of a box's faces: low and high x, y, z. Corner bits: 1 = high x, 2 = high y, 4 = high z.
const std::array<Corners, 6> box_faces = {
    {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};

/// Each edge once, by the face that has its ends in ascending order of the two visits.
std::vector<Convex::Edge> edges_of(const std::vector<Convex::Face>& faces) {
  std::map<std::pair<std::uint16_t, std::uint16_t>, std::uint16_t> face_along;  // directed edge to face
  for (std::uint16_t face = 0; face < faces.size(); ++face) {
    const Corners& corners = faces[face].corners;
    for (std::size_t i = 0; i < corners.size(); ++i) {
      if (!face_along.emplace(std::pair(corners[i], corners[(i + 1) % corners.size()]), face).second) {
        throw std::invalid_argument("convex solid: two faces run along an edge in the same direction");
      }
    }
  }
  std::vector<Convex::Edge> edges;
  for (const auto& [ends, face] : face_along) {
    const auto other = face_along.find({ends.second, ends.first});
    if (other == face_along.end()) throw std::invalid_argument("convex solid: an edge has only one face");
    if (ends.first < ends.second) edges.push_back({{ends.first, ends.second}, {face, other->second}});
  }
  return edges;
}

Convex with_normals(std::vector<glm::dvec3> vertices, std::vector<Convex::Face> faces) {
  Convex convex{std::move(vertices), std::move(faces), {}};
  for (Convex::Face& face : convex.faces) face.offset = farthest_beyond(convex.vertices, face.normal, 0);
  convex.edges = edges_of(convex.faces);
  return convex;
}

/// Newell's; zero for what has no area.
glm::dvec3 normal_of(const std::vector<glm::dvec3>& vertices, const Corners& corners) {
  glm::dvec3 sum{};
  const glm::dvec3& origin = vertices[corners[0]];
  for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
    sum += glm::cross(vertices[corners[i]] - origin, vertices[corners[i + 1]] - origin);
  }
  const double length = glm::length(sum);
  return length > 0 ? sum / length : glm::dvec3{};
}

}  // namespace

double farthest_beyond(std::span<const glm::dvec3> vertices, const glm::dvec3& normal, double offset) {
  double farthest = -std::numeric_limits<double>::infinity();
  for (const glm::dvec3& vertex : vertices) farthest = std::max(farthest, glm::dot(normal, vertex) - offset);
  return farthest;
}

Convex convex_turned_box(std::vector<glm::dvec3> corners) {
  return convex_from_faces(std::move(corners), {box_faces.begin(), box_faces.end()});
}

Convex convex_box(const Box& box) {
  std::vector<glm::dvec3> vertices;
  for (unsigned corner = 0; corner < 8; ++corner) {
    vertices.emplace_back((corner & 1 ? box.high : box.low)[0], (corner & 2 ? box.high : box.low)[1],
                          (corner & 4 ? box.high : box.low)[2]);
  }
  std::vector<Convex::Face> faces;
  for (int face = 0; face < 6; ++face) {
    glm::dvec3 normal{};
    normal[face / 2] = face % 2 == 0 ? -1 : 1;
    faces.push_back({normal, 0, box_faces[static_cast<std::size_t>(face)]});
  }
  return with_normals(std::move(vertices), std::move(faces));
}

Convex convex_prism(const std::array<glm::vec3, 3>& ground, float low, float high) {
  std::vector<glm::dvec3> vertices;
  std::array<glm::dvec3, 3> at = {ground[0], ground[1], ground[2]};
  glm::dvec3 up = glm::cross(at[1] - at[0], at[2] - at[0]);
  if (up.z < 0) std::swap(at[1], at[2]), up = -up;
  const double length = glm::length(up);
  up = length > 0 ? up / length : glm::dvec3{0, 0, 1};
  for (const float height : {low, high}) {
    for (const glm::dvec3& corner : at) vertices.push_back(corner + glm::dvec3(0, 0, height));
  }
  std::vector<Convex::Face> faces = {{-up, 0, {0, 2, 1}}, {up, 0, {3, 4, 5}}};
  for (std::uint16_t i = 0; i < 3; ++i) {
    const auto next = static_cast<std::uint16_t>((i + 1) % 3);
    const glm::dvec3 along = at[next] - at[i];
    const double across = glm::length(glm::dvec3(along.y, -along.x, 0));
    faces.push_back({across > 0 ? glm::dvec3(along.y, -along.x, 0) / across : glm::dvec3{1, 0, 0},
                     0,
                     {i, next, static_cast<std::uint16_t>(next + 3), static_cast<std::uint16_t>(i + 3)}});
  }
  return with_normals(std::move(vertices), std::move(faces));
}

Convex convex_polygon(std::span<const glm::dvec3> corners, const glm::dvec3& normal) {
  Corners front, back;
  for (std::uint16_t i = 0; i < corners.size(); ++i) front.push_back(i);
  back.assign(front.rbegin(), front.rend());
  return with_normals({corners.begin(), corners.end()}, {{normal, 0, front}, {-normal, 0, back}});
}

Convex convex_plate(std::span<const glm::dvec3> corners, const glm::dvec3& normal) {
  const auto count = static_cast<std::uint16_t>(corners.size());
  std::vector<glm::dvec3> vertices(corners.begin(), corners.end());
  vertices.insert(vertices.end(), corners.begin(), corners.end());
  std::vector<Convex::Face> faces = {{-normal, 0, {}}, {normal, 0, {}}};
  for (std::uint16_t i = 0; i < count; ++i) {
    const auto next = static_cast<std::uint16_t>((i + 1) % count);
    faces[0].corners.insert(faces[0].corners.begin(), i);
    faces[1].corners.push_back(static_cast<std::uint16_t>(i + count));
    faces.push_back(
        {glm::normalize(glm::cross(corners[next] - corners[i], normal)),
         0,
         {i, next, static_cast<std::uint16_t>(next + count), static_cast<std::uint16_t>(i + count)}});
  }
  return with_normals(std::move(vertices), std::move(faces));
}

Convex convex_from_faces(std::vector<glm::dvec3> vertices,
                         std::vector<std::vector<std::uint16_t>> corners_of_face) {
  std::vector<Convex::Face> faces;
  for (Corners& corners : corners_of_face) {
    const glm::dvec3 normal = normal_of(vertices, corners);
    faces.push_back({normal, 0, std::move(corners)});
  }
  return with_normals(std::move(vertices), std::move(faces));
}

}  // namespace vismat
