// ALGORITHM. A triangle is culled where n.(w - b) < 0 for its normal n, a corner b and every point w of the cell. A group is
// culled where that holds for all normals of its cone and all points b of its box. For one normal direction set, the u
// with n.u < 0 for all n are a convex cone, so it is enough to look at the 8 corners u of the box of differences w - b: each
// must make more than a right angle plus the cone's half angle with the cone's axis. That is simpler than the paper's cones
// of visibility from the corners of each group's box, and needs no claim that these are extreme. The same test turned
// round, from the cell's middle, finds groups that face it whole. What neither test settles is split, down to triangles,
// which are tested by themselves: so the number is that of the test of every triangle.
// Triangles are first sorted by the axis direction nearest to their normal, then by halves of their box: walls get cones of
// no width.
#include "visibility/detail/back_faces.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <numeric>

namespace vismat {
namespace {

using glm::dvec3;

constexpr std::uint32_t leaf_size = 8;
// Cones are tested by angles whose sine and lengths carry a few roundings; what they settle must clear them.
constexpr double slack = 1e-9;

unsigned nearest_axis(const dvec3& n) {
  const dvec3 a = glm::abs(n);
  const unsigned axis = a.x >= a.y && a.x >= a.z ? 0 : a.y >= a.z ? 1 : 2;
  return 2 * axis + (n[static_cast<int>(axis)] < 0 ? 1 : 0);
}

/// Whether n.u < 0 for all corners u of the box and all n of the cone.
bool all_behind(const dvec3& low, const dvec3& high, const dvec3& axis, double sine) {
  if (sine > 1) return false;
  for (unsigned corner = 0; corner < 8; ++corner) {
    const dvec3 u(corner & 1 ? high.x : low.x, corner & 2 ? high.y : low.y, corner & 4 ? high.z : low.z);
    const double length = glm::length(u);
    if (!(glm::dot(u, axis) < -(sine + slack) * length - slack * (1 + length))) return false;
  }
  return true;
}

}  // namespace

bool is_closed_outward(const Mesh& mesh) {
  const std::vector<MeshSide> sides = sides_of(mesh);
  for (std::size_t i = 0; i < sides.size();) {
    int balance = 0;
    std::size_t end = i;
    for (; end < sides.size() && sides[end].ends == sides[i].ends; ++end)
      balance += sides[end].forward ? 1 : -1;
    if (balance != 0) return false;
    i = end;
  }
  double volume = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const dvec3& origin = mesh.vertices[0];
    volume +=
        glm::dot(mesh.vertices[a] - origin, glm::cross(mesh.vertices[b] - origin, mesh.vertices[c] - origin));
  }
  return volume > 0;
}

BackFaces::BackFaces(std::span<const dvec3> vertices,
                     std::span<const std::array<std::uint32_t, 3>> triangles) {
  std::vector<Plane> planes;
  planes.reserve(triangles.size());
  for (const auto& [a, b, c] : triangles) {
    const dvec3 ab = vertices[b] - vertices[a], ac = vertices[c] - vertices[a];
    planes.push_back({glm::cross(ab, ac), vertices[a], 1e-14 * glm::length(ab) * glm::length(ac)});
  }
  std::vector<std::uint32_t> order(triangles.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return nearest_axis(planes[a].normal) < nearest_axis(planes[b].normal);
  });
  for (std::size_t from = 0; from < order.size();) {
    std::size_t to = from;
    const unsigned axis = nearest_axis(planes[order[from]].normal);
    while (to < order.size() && nearest_axis(planes[order[to]].normal) == axis) ++to;
    build(std::span(order).subspan(from, to - from), static_cast<std::uint32_t>(from), planes, vertices,
          triangles);
    from = to;
  }
  planes_.reserve(planes.size());
  for (const std::uint32_t triangle : order) planes_.push_back(planes[triangle]);
}

void BackFaces::build(std::span<std::uint32_t> order, std::uint32_t first, const std::vector<Plane>& planes,
                      std::span<const dvec3> vertices,
                      std::span<const std::array<std::uint32_t, 3>> triangles) {
  const std::size_t at = clusters_.size();
  Cluster cluster;
  cluster.first = first;
  cluster.count = static_cast<std::uint32_t>(order.size());
  cluster.leaf = order.size() <= leaf_size;
  dvec3 sum(0);
  bool flat = false;  // a triangle without area faces nowhere and everywhere
  for (const std::uint32_t triangle : order) {
    for (const std::uint32_t corner : triangles[triangle]) grow(cluster.bounds, vertices[corner]);
    const double length = glm::length(planes[triangle].normal);
    flat = flat || !(length > planes[triangle].rounding * 1e10);
    if (length > 0) sum += planes[triangle].normal / length;
  }
  if (!flat && glm::length(sum) > 0) {
    cluster.axis = glm::normalize(sum);
    double cosine = 1, sine = 0;
    for (const std::uint32_t triangle : order) {
      const dvec3 n = glm::normalize(planes[triangle].normal);
      cosine = std::min(cosine, glm::dot(n, cluster.axis));
      sine = std::max(sine, glm::length(glm::cross(n, cluster.axis)));
    }
    if (cosine > 0) cluster.sine = sine;
  }
  clusters_.push_back(cluster);
  if (!cluster.leaf) {
    const dvec3 size = cluster.bounds.high - cluster.bounds.low;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const auto middle = [&](std::uint32_t t) {
      return vertices[triangles[t][0]][axis] + vertices[triangles[t][1]][axis] +
             vertices[triangles[t][2]][axis];
    };
    const std::size_t half = order.size() / 2;
    std::nth_element(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(half), order.end(),
                     [&](std::uint32_t a, std::uint32_t b) {
                       const double x = middle(a), y = middle(b);
                       return x < y || (x == y && a < b);
                     });
    build(order.first(half), first, planes, vertices, triangles);
    build(order.subspan(half), first + static_cast<std::uint32_t>(half), planes, vertices, triangles);
  }
  clusters_[at].next = static_cast<std::uint32_t>(clusters_.size());
}

std::uint64_t BackFaces::facing(const Box& cell) const {
  const auto [low, high] = bounds_of(cell);
  const dvec3 middle = (low + high) / 2.0;
  std::uint64_t facing = 0;
  for (std::uint32_t i = 0; i < clusters_.size();) {
    const Cluster& c = clusters_[i];
    if (all_behind(low - c.bounds.high, high - c.bounds.low, c.axis, c.sine)) {
      i = c.next;
    } else if (all_behind(middle - c.bounds.high, middle - c.bounds.low, -c.axis, c.sine)) {
      facing += c.count;
      i = c.next;
    } else if (c.leaf) {
      for (std::uint32_t t = c.first; t < c.first + c.count; ++t) {
        const Plane& plane = planes_[t];
        const dvec3 nearest =
            glm::max(plane.normal * (low - plane.corner), plane.normal * (high - plane.corner));
        const dvec3 reach = glm::max(glm::abs(low - plane.corner), glm::abs(high - plane.corner));
        if (nearest.x + nearest.y + nearest.z >= -plane.rounding * (reach.x + reach.y + reach.z)) ++facing;
      }
      i = c.next;
    } else {
      ++i;
    }
  }
  return facing;
}

}  // namespace vismat
