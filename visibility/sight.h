// What is known of the visibility from view cells: the objects that are surely seen, and those that are not surely hidden.
#pragma once
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "matrix/visibility_matrix.h"

namespace vismat {

/// Proof that an object is seen: a point of the view cell and a point of the object, with nothing opaque between them.
struct SightLine {
  glm::vec3 from{}, to{};
  bool operator==(const SightLine&) const = default;
};

/// Cells x objects. An object is seen, hidden (in neither matrix), or undecided (not hidden, not seen).
struct Sight {
  VisibilityMatrix seen;         // a ray reached it: a lower bound
  VisibilityMatrix not_hidden;   // no occluder was proven to hide it: an upper bound, seen included
  std::vector<SightLine> lines;  // one for each entry of `seen`, in order
  std::vector<float> degree;     // one for each entry of `seen`, see degree_of_visibility in sampled.h
  std::uint64_t rays = 0;
};

}  // namespace vismat
