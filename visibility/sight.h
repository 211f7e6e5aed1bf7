// What is known of the visibility from view cells: the objects that are surely seen, and those that are not surely hidden.
#pragma once
#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <vector>

#include "matrix/visibility_matrix.h"

namespace vismat {

/// Proof that an object is seen: a point of the view cell and a point of the object, with nothing opaque between them.
struct SightLine {
  glm::vec3 from{}, to{};
  bool operator==(const SightLine&) const = default;
};

/// What rays that took no part in the search say of its result: see held_back_error in sampled.h.
struct HeldBack {
  std::uint64_t rays = 0,
                missed_rays = 0;  // in random directions, that saw anything; an object that is not listed
  std::uint64_t objects = 0,
                missed_objects = 0;  // that these and as many rays aimed at random objects saw; not listed
  bool operator==(const HeldBack&) const = default;
};

/// Cells x objects. An object is seen, hidden (in neither matrix), or undecided (not hidden, not seen). Of what a
/// producer does not tell, seen or not_hidden, the matrix may be without rows.
struct Sight {
  VisibilityMatrix seen;         // a ray reached it: a lower bound
  VisibilityMatrix not_hidden;   // no occluder was proven to hide it: an upper bound, seen included
  std::vector<SightLine> lines;  // one for each entry of `seen`, in order
  std::vector<float> degree;     // one for each entry of `seen`, see degree_of_visibility in sampled.h
  std::uint64_t rays = 0;
  std::optional<std::uint64_t> last_found;  // entries of `seen` that the last of several passes added
  std::optional<HeldBack> held_back;        // over all cells
  bool operator==(const Sight&) const = default;
};

}  // namespace vismat
