// ALGORITHM. A face of one solid is lit if part of the other lies in front of it. Edges between a lit and an unlit face form
// the outline that the other sees of it, and through each goes exactly one plane that has both solids on the same side and
// touches the other: turn a plane about the edge, starting from the lit face, until it has passed the last vertex. That every
// closed outline gives a plane for each of its edges is what keeps this safe near ties: a face that is lit or not by a
// rounding error moves the outline to planes that differ as little, and none is missing.
#include "visibility/shadows/supporting_planes.h"

#include <algorithm>
#include <glm/geometric.hpp>

namespace vismat {
namespace {

double nearest(const Convex& solid, const Convex::Face& face) {
  return -farthest_beyond(solid.vertices, -face.normal, -face.offset);
}

void add_planes(const Convex& solid, const Convex& other, std::size_t first_plane,
                std::vector<Plane>& planes) {
  constexpr double same = 1e-10;  // between unit normals: planes of parallel edges come from both solids
  thread_local std::vector<char> lit;
  lit.resize(solid.faces.size());
  for (std::size_t i = 0; i < lit.size(); ++i) {
    lit[i] = farthest_beyond(other.vertices, solid.faces[i].normal, solid.faces[i].offset) > 0;
  }
  for (const Convex::Edge& edge : solid.edges) {
    if (lit[edge.faces[0]] == lit[edge.faces[1]]) continue;
    const unsigned first = lit[edge.faces[0]] ? 0 : 1;
    const glm::dvec3 &a = solid.vertices[edge.ends[first]], along = solid.vertices[edge.ends[1 - first]] - a;
    if (along == glm::dvec3{}) continue;
    const glm::dvec3& towards = solid.faces[edge.faces[first]].normal;
    glm::dvec3 normal = -towards;  // stays where the lit face is lit by a rounding error alone
    double front = 0;
    for (const glm::dvec3& vertex : other.vertices) {
      if (const double distance = glm::dot(towards, vertex - a); distance > front) {
        front = distance;
        normal = glm::cross(vertex - a, along);
      }
    }
    for (const glm::dvec3& vertex : other.vertices) {
      if (glm::dot(normal, vertex - a) < 0) normal = glm::cross(vertex - a, along);
    }
    normal = glm::normalize(normal);
    const bool known =
        std::any_of(planes.begin() + static_cast<std::ptrdiff_t>(first_plane), planes.end(),
                    [&](const Plane& plane) { return glm::distance(plane.normal, normal) < same; });
    if (!known) planes.push_back({normal, glm::dot(normal, a)});
  }
}

}  // namespace

bool apart(const Convex& cell, const Convex& occluder, double gap, bool flat) {
  const auto beyond = [](const Convex& faces, const Convex& all, double least) {
    return std::any_of(faces.faces.begin(), faces.faces.end(),
                       [&](const Convex::Face& face) { return nearest(all, face) >= least; });
  };
  return beyond(occluder, cell, flat ? gap : 0) || (!flat && beyond(cell, occluder, 0));
}

void supporting_planes(const Convex& cell, const Convex& occluder, bool flat, std::vector<Plane>& planes,
                       std::size_t first) {
  add_planes(occluder, cell, first, planes);
  if (!flat) add_planes(cell, occluder, first, planes);
}

}  // namespace vismat
