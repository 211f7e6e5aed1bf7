// ALGORITHM. Candidates by search, soundness by proof at the end, see find_occluders. Each object's parts are made solids where
// they are closed (solid_occluders.cpp) and polygons where they are not (flat_occluders.cpp).
#include "visibility/shadows/occluders.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <map>
#include <numeric>
#include <utility>

#include "matrix/base/parallel.h"
#include "visibility/geometry/point_bounds.h"
#include "visibility/shadows/coplanar.h"
#include "visibility/shadows/flat_occluders.h"
#include "visibility/shadows/solid_occluders.h"

namespace vismat {
namespace {

using glm::dvec3;
using Triangle = std::array<std::uint32_t, 3>;

Mesh part_of(const Mesh& mesh, std::span<const std::uint32_t> triangles) {
  Mesh part;
  std::map<std::uint32_t, std::uint32_t> number;
  for (const std::uint32_t t : triangles) {
    Triangle corners{};
    for (unsigned i = 0; i < 3; ++i) {
      const auto [at, fresh] =
          number.emplace(mesh.triangles[t][i], static_cast<std::uint32_t>(part.vertices.size()));
      if (fresh) part.vertices.push_back(mesh.vertices[mesh.triangles[t][i]]);
      corners[i] = at->second;
    }
    part.triangles.push_back(corners);
  }
  return part;
}

void append(Mesh& mesh, const Mesh& other) {
  const auto base = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), other.vertices.begin(), other.vertices.end());
  for (const Triangle& t : other.triangles) mesh.triangles.push_back({t[0] + base, t[1] + base, t[2] + base});
}

/// Whether as many triangles run along each side one way as the other, once the part is closed where it is open on the lowest
/// plane, through which no sight line enters.
bool close_on_ground(Mesh& part, double ground) {
  const std::vector<MeshSide> sides = sides_of(part);
  std::vector<Triangle> cap;  // a cone over the open sides
  for (std::size_t i = 0; i < sides.size();) {
    int balance = 0;
    const std::array<std::uint32_t, 2> ends = sides[i].ends;
    for (; i < sides.size() && sides[i].ends == ends; ++i) balance += sides[i].forward ? 1 : -1;
    if (balance == 0) continue;
    if (part.vertices[ends[0]].z != ground || part.vertices[ends[1]].z != ground) return false;
    const std::uint32_t top = cap.empty() ? ends[0] : cap[0][2];
    const auto [from, to] = balance > 0 ? std::pair(ends[1], ends[0]) : std::pair(ends[0], ends[1]);
    cap.insert(cap.end(), static_cast<std::size_t>(std::abs(balance)), {from, to, top});
  }
  std::erase_if(cap, [](const Triangle& t) { return t[0] == t[2] || t[1] == t[2]; });
  part.triangles.insert(part.triangles.end(), cap.begin(), cap.end());
  return true;
}

void make_occluders(OccluderMaker& maker, const Mesh& mesh) {
  if (mesh.triangles.empty()) return;
  const Bounds bounds = bounds_of(mesh.vertices);
  maker.size = largest_coordinate(bounds.high - bounds.low);
  maker.magnitude = std::max(largest_coordinate(bounds.high), largest_coordinate(bounds.low));

  const std::vector<MeshSide> sides = sides_of(mesh);
  const std::vector<std::uint32_t> part_of_triangle = parts_by_sides(mesh, sides);
  std::vector<std::vector<std::uint32_t>> parts(
      *std::max_element(part_of_triangle.begin(), part_of_triangle.end()) + 1u);
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) parts[part_of_triangle[t]].push_back(t);

  Mesh solids, hollows, open;  // all closed parts; those that are not convex; the rest
  bool outward = false, inward = false;
  for (const std::vector<std::uint32_t>& triangles : parts) {
    Mesh part = part_of(mesh, triangles);
    orient(part, sides_of(part));
    if (!close_on_ground(part, maker.options.extend_below_ground ? maker.ground : std::nan(""))) {
      append(open, part);
      continue;
    }
    append(solids, part);
    const int winding = add_convex(maker, part, coplanar_faces(part, sides_of(part), maker.tolerance()));
    if (winding == 0) append(hollows, part);
    outward |= winding > 0, inward |= winding < 0;
  }
  if (!hollows.triangles.empty() || (outward && inward)) {  // a convex part may be another's cavity
    const double largest_side = add_boxes(maker, solids);
    add_polygons(maker, hollows, coplanar_faces(hollows, sides_of(hollows), maker.tolerance()),
                 1.1 * largest_side);
  }
  if (!open.triangles.empty())
    add_polygons(maker, open, coplanar_faces(open, sides_of(open), maker.tolerance()), 0);
}

bool is_finite(const Scene& scene, std::span<const std::uint32_t> triangles) {
  return std::all_of(triangles.begin(), triangles.end(), [&](std::uint32_t t) {
    for (const glm::vec3& p : corners_of(scene, t)) {
      if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) return false;
    }
    return true;
  });
}

}  // namespace

float lowest_point(const Scene& scene) {
  float lowest = std::numeric_limits<float>::infinity();
  for (const std::uint32_t index : scene.indices) lowest = std::min(lowest, scene.vertices[index].z);
  return scene.indices.empty() ? 0 : lowest;
}

std::vector<Occluder> find_occluders(const Scene& scene, const OccluderOptions& options) {
  std::vector<dvec3> corners(scene.vertices.begin(), scene.vertices.end());
  const Bounds bounds = bounds_of(corners);
  const double depth = corners.empty() ? 0 : glm::length(bounds.high - bounds.low);
  const double ground = lowest_point(scene);

  const ObjectTriangles triangles_of(scene);
  std::vector<std::vector<Occluder>> made(scene.object_count);
  parallel_for(scene.object_count, options.threads, [&](std::uint64_t object) {
    if (!scene.see_through.empty() && scene.see_through[object]) return;
    const auto triangles = triangles_of.of(static_cast<std::uint32_t>(object));
    if (!is_finite(scene, triangles)) return;
    OccluderMaker maker{options, ground, depth, static_cast<std::uint32_t>(object)};
    make_occluders(maker, mesh_of(scene.vertices, scene.indices, triangles));
    made[object] = std::move(maker.made);
  });
  std::vector<Occluder> all;
  for (std::vector<Occluder>& some : made) {
    all.insert(all.end(), std::make_move_iterator(some.begin()), std::make_move_iterator(some.end()));
  }
  return all;
}

bool blocks_from(const Occluder& occluder, const Convex& cell) {
  if (occluder.grazing > 0) {
    const Convex::Face& front = occluder.shape.faces[0];
    double height = -farthest_beyond(cell.vertices, -front.normal, -front.offset);
    if (!occluder.one_sided)
      height = std::max(height, -farthest_beyond(cell.vertices, front.normal, front.offset));
    double farthest = 0;
    for (const dvec3& from : cell.vertices) {
      for (const dvec3& to : occluder.shape.vertices) farthest = std::max(farthest, glm::distance(from, to));
    }
    if (height <= occluder.grazing * farthest) return false;
  }
  if (!occluder.within) return true;
  const Enclosure& around = *occluder.within;
  Bounds bounds = bounds_of(cell.vertices);
  const dvec3 margin(1e-6 * largest_coordinate(around.bounds.high - around.bounds.low) +
                     1e-9 * largest_coordinate(bounds.high));
  bounds.low -= margin, bounds.high += margin;
  if (!meet(bounds, around.bounds)) return true;
  return !enters_box(around.surface, bounds) &&
         winding_number(around.surface, (bounds.low + bounds.high) / 2.0) == 0;
}

}  // namespace vismat
