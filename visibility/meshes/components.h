// Makes objects from loose triangles: joins their vertices and splits them into connected components.
#pragma once
#include <cstdint>

#include "visibility/scene.h"

namespace vismat {

struct WeldCounts {
  std::uint64_t joined = 0;     // vertices that were joined with another, or had no triangle
  std::uint64_t zero_area = 0;  // triangles left out
  /// Triangles that are left out because another of the same object has the same three vertices, in any order.
  std::uint64_t duplicates = 0;
  std::uint64_t non_manifold_edges = 0;  // with more than two triangles; kept
  bool operator==(const WeldCounts&) const = default;
};

/// Joins vertices that are equal (-0 is 0) or, with a tolerance, at most that far from the first of them, whose place
/// they take. Then leaves out triangles that have no area, duplicates, and vertices without triangles. The others keep
/// their order, and objects keep their numbers, even if nothing is left of them. `tolerance` is 0 or at least 1e-6 of
/// the scene's units, otherwise throws std::invalid_argument. By hashing, about O(vertices). Deterministic.
WeldCounts weld(Scene& scene, float tolerance = 0);

/// Makes each connected component of triangles that share vertices (by index: weld first) an object; objects are
/// numbered by their first triangle. See-through and opaque triangles are never in one component. Throws
/// std::invalid_argument for more than 2^31 - 1 vertices. O(n log n) at worst.
void split_into_components(Scene& scene);
/// Makes each triangle an object.
void split_into_triangles(Scene& scene);

}  // namespace vismat
