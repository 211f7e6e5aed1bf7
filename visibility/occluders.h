// What hides: convex pieces of a scene that no sight line passes.
#pragma once
#include <cstdint>
#include <vector>

#include "visibility/convex.h"
#include "visibility/scene.h"

namespace vismat {

/// Every segment that meets `shape` and ends outside of it crosses a triangle of the object (or runs inside its solid).
struct Occluder {
  Convex shape;
  std::uint32_t object = 0;  // whose it is
  bool flat = false;         // a polygon; otherwise a solid
};

struct OccluderOptions {
  std::uint32_t boxes_per_object = 8;      // at most, inside a closed object that is not convex
  std::uint32_t polygons_per_object = 64;  // at most, the largest; of what is not closed
  float smallest = 0.5f;  // metres; occluders that are narrower along their second longest side are left out
  bool extend_below_ground =
      true;  // solids that stand on the scene's lowest plane reach far below it, where nobody looks
  unsigned threads = 0;  // 0: one a core
};

/// Ascending by object. Deterministic.
std::vector<Occluder> find_occluders(const Scene& scene, const OccluderOptions& options = {});

}  // namespace vismat
