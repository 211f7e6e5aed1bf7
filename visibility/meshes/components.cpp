// ALGORITHM. Vertices meet in a hash grid: its squares are the coordinates' bits themselves, or cubes of twice the tolerance, of
// which eight are within reach of a vertex. Each vertex joins the lowest-numbered one in reach that has joined no other, so that
// chains of close vertices do not drift, and the order of the table does not matter. Components are the sets of a union-find.
#include "visibility/meshes/components.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include <glm/geometric.hpp>

#include "matrix/base/union_find.h"

namespace vismat {
namespace {

constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

class HashGrid {
 public:
  HashGrid(const std::vector<glm::vec3>& points, float tolerance)
      : points_(points), tolerance_(tolerance), next_(points.size(), none) {
    first_.reserve(points.size() / 2);
  }
  /// The lowest point in reach that was kept before; otherwise keeps this one and returns it.
  std::uint32_t join(std::uint32_t point) {
    const auto squares = tolerance_ > 0 ? 8u : 1u;
    std::uint32_t lowest = none;
    for (unsigned square = 0; square < squares; ++square) {
      const auto found = first_.find(key(point, square));
      if (found == first_.end()) continue;
      for (std::uint32_t other = found->second; other != none; other = next_[other]) {
        if (other < lowest && near(point, other)) lowest = other;
      }
    }
    if (lowest != none) return lowest;
    next_[point] = std::exchange(first_.try_emplace(key(point, 0), none).first->second, point);
    return point;
  }

 private:
  bool near(std::uint32_t a, std::uint32_t b) const {
    return tolerance_ > 0 ? glm::distance(glm::dvec3(points_[a]), glm::dvec3(points_[b])) <= tolerance_
                          : points_[a] == points_[b];
  }
  /// Of the point's square, or of one of the seven others within reach.
  std::uint64_t key(std::uint32_t point, unsigned square) const {
    std::uint64_t hash = 0;
    for (int axis = 0; axis < 3; ++axis) {
      std::uint64_t cell = std::bit_cast<std::uint32_t>(points_[point][axis] + 0.0f);
      if (tolerance_ > 0) {
        const double place = points_[point][axis] / (2.0 * tolerance_), low = std::floor(place);
        const bool beside = (square >> axis & 1) != 0;
        cell = static_cast<std::uint64_t>(static_cast<std::int64_t>(low) + (!beside             ? 0
                                                                            : place - low < 0.5 ? -1
                                                                                                : 1));
      }
      hash = (hash ^ cell) * 0x9e3779b97f4a7c15;
      hash ^= hash >> 29;
    }
    return hash;
  }
  const std::vector<glm::vec3>& points_;
  double tolerance_;
  std::unordered_map<std::uint64_t, std::uint32_t> first_;
  std::vector<std::uint32_t> next_;  // kept points of the same hash
};

bool has_area(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  return glm::cross(b - a, c - a) != glm::dvec3(0);
}

/// 1 for each triangle that has no double before it.
std::vector<bool> first_of_doubles(const Scene& scene) {
  struct Key {
    std::array<std::uint32_t, 4> corners_object;
    std::uint32_t triangle;
    auto operator<=>(const Key&) const = default;
  };
  std::vector<Key> keys(scene.object_of_triangle.size());
  for (std::uint32_t t = 0; t < keys.size(); ++t) {
    std::array<std::uint32_t, 3> corners;
    std::copy_n(scene.indices.begin() + std::ptrdiff_t{3} * t, 3, corners.begin());
    std::sort(corners.begin(), corners.end());
    keys[t] = {{corners[0], corners[1], corners[2], scene.object_of_triangle[t]}, t};
  }
  std::sort(keys.begin(), keys.end());
  std::vector<bool> first(keys.size(), true);
  for (std::size_t i = 1; i < keys.size(); ++i) {
    first[keys[i].triangle] = keys[i].corners_object != keys[i - 1].corners_object;
  }
  return first;
}

void keep_triangles(Scene& scene, const auto& keep) {
  std::size_t kept = 0;
  for (std::size_t t = 0; t < scene.object_of_triangle.size(); ++t) {
    if (!keep(t)) continue;
    std::copy_n(scene.indices.begin() + static_cast<std::ptrdiff_t>(3 * t), 3,
                scene.indices.begin() + static_cast<std::ptrdiff_t>(3 * kept));
    scene.object_of_triangle[kept++] = scene.object_of_triangle[t];
  }
  scene.indices.resize(3 * kept);
  scene.object_of_triangle.resize(kept);
}

std::uint64_t crowded_edges(const Scene& scene) {
  std::vector<std::uint64_t> edges(scene.indices.size());
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const std::uint32_t a = scene.indices[i], b = scene.indices[i % 3 == 2 ? i - 2 : i + 1];
    edges[i] = std::uint64_t{std::min(a, b)} << 32 | std::max(a, b);
  }
  std::sort(edges.begin(), edges.end());
  std::uint64_t crowded = 0;
  for (std::size_t i = 0, end; i < edges.size(); i = end) {
    for (end = i + 1; end < edges.size() && edges[end] == edges[i];) ++end;
    crowded += end - i > 2;
  }
  return crowded;
}

}  // namespace

WeldCounts weld(Scene& scene, float tolerance) {
  if (!(tolerance == 0 || (tolerance >= 1e-6f && tolerance <= 1e9f))) {
    throw std::invalid_argument("weld: the tolerance is 0 or between 1e-6 and 1e9");
  }
  WeldCounts counts;
  HashGrid grid(scene.vertices, tolerance);
  std::vector<std::uint32_t> vertex_of_old(scene.vertices.size());
  for (std::uint32_t v = 0; v < vertex_of_old.size(); ++v) vertex_of_old[v] = grid.join(v);
  for (std::uint32_t& index : scene.indices) index = vertex_of_old[index];

  const std::size_t triangles = scene.object_of_triangle.size();
  keep_triangles(scene, [&](std::size_t t) {
    const auto corner = [&](std::size_t c) { return glm::dvec3(scene.vertices[scene.indices[3 * t + c]]); };
    return has_area(corner(0), corner(1), corner(2));
  });
  counts.zero_area = triangles - scene.object_of_triangle.size();
  const std::vector<bool> first = first_of_doubles(scene);
  keep_triangles(scene, [&](std::size_t t) { return first[t]; });
  counts.duplicates = triangles - counts.zero_area - scene.object_of_triangle.size();
  counts.non_manifold_edges = crowded_edges(scene);

  vertex_of_old.assign(scene.vertices.size(), none);  // now: of those in use
  for (const std::uint32_t index : scene.indices) vertex_of_old[index] = 0;
  std::uint32_t used = 0;
  for (std::uint32_t v = 0; v < vertex_of_old.size(); ++v) {
    if (vertex_of_old[v] == none) continue;
    scene.vertices[used] = scene.vertices[v];
    vertex_of_old[v] = used++;
  }
  counts.joined = scene.vertices.size() - used;
  scene.vertices.resize(used);
  for (std::uint32_t& index : scene.indices) index = vertex_of_old[index];
  return counts;
}

void split_into_components(Scene& scene) {
  // A vertex stands twice: for what is opaque and for what is seen through.
  if (scene.vertices.size() > none / 2)
    throw std::invalid_argument("components: more than 2147483647 vertices");
  const auto nodes = static_cast<std::uint32_t>(2 * scene.vertices.size());
  UnionFind joined(nodes);
  const auto clear = [&](std::size_t t) {
    return !scene.see_through.empty() && scene.see_through[scene.object_of_triangle[t]] != 0;
  };
  const auto node = [&](std::size_t t, std::size_t corner) {
    return 2 * scene.indices[3 * t + corner] + clear(t);
  };
  for (std::size_t t = 0; t < scene.object_of_triangle.size(); ++t) {
    for (const std::size_t corner : {1, 2}) joined.join_sets(node(t, 0), node(t, corner));
  }
  std::vector<std::uint32_t> object_of_root(nodes, none);
  std::vector<std::uint8_t> see_through;
  std::uint32_t objects = 0;
  for (std::size_t t = 0; t < scene.object_of_triangle.size(); ++t) {
    std::uint32_t& object = object_of_root[joined.find(node(t, 0))];
    if (object == none) {
      object = objects++;
      if (!scene.see_through.empty()) see_through.push_back(clear(t));
    }
    scene.object_of_triangle[t] = object;
  }
  scene.object_count = objects;
  scene.see_through = std::move(see_through);
  scene.object_names.clear();
}

void split_into_triangles(Scene& scene) {
  const auto triangles = static_cast<std::uint32_t>(scene.object_of_triangle.size());
  if (!scene.see_through.empty()) {
    std::vector<std::uint8_t> see_through(triangles);
    for (std::uint32_t t = 0; t < triangles; ++t)
      see_through[t] = scene.see_through[scene.object_of_triangle[t]];
    scene.see_through = std::move(see_through);
  }
  scene.object_names.clear();
  std::iota(scene.object_of_triangle.begin(), scene.object_of_triangle.end(), 0u);
  scene.object_count = triangles;
}

}  // namespace vismat
