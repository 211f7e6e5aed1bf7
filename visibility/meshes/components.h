// Makes objects of loose triangles: joins their vertices and splits them into connected components.
#pragma once
#include <cstdint>

#include "visibility/scene.h"

namespace vismat {

struct WeldCounts {
  std::uint64_t joined = 0;     // vertices that became another, or belonged to no triangle
  std::uint64_t zero_area = 0;  // triangles left out
  /// Triangles left out that have the same three vertices, in any order, as another of the same object.
  std::uint64_t duplicates = 0;
  std::uint64_t non_manifold_edges = 0;  // with more than two triangles; kept
  bool operator==(const WeldCounts&) const = default;
};

/// Makes vertices one that are equal (-0 is 0) or, with a tolerance, at most so far from the first of them, whose place
/// they take; then leaves out triangles that have no area, doubles, and vertices of no triangle. The others keep their order, and
/// objects their numbers, even if nothing is left of them. `tolerance` is 0 or at least 1e-6 of the scene's units, otherwise
/// std::invalid_argument. By hashing, about O(vertices).
/// Deterministic.
WeldCounts weld(Scene& scene, float tolerance = 0);

/// Objects become the connected components of triangles that share vertices (by index: weld first), numbered by their first
/// triangle. What is see-through and what is not are never one component. At most 2^31 - 1 vertices, otherwise
/// std::invalid_argument. O(n a(n)).
void split_into_components(Scene& scene);
/// Objects become the triangles.
void split_into_triangles(Scene& scene);

}  // namespace vismat
