// What is known about the visibility from view cells: the objects that are proven seen, and those that are not proven
// hidden.
#pragma once
#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <vector>

#include "matrix/box.h"
#include "matrix/source_map.h"
#include "matrix/visibility_matrix.h"

namespace vismat {

/// Proof that an object is seen: a point of the view cell and a point of the object, with nothing opaque between them.
struct SightLine {
  glm::vec3 from{}, to{};
  bool operator==(const SightLine&) const = default;
};

/// An estimate of what was missed, from rays that the search did not use: see held_back_error in sampled.h.
struct HeldBack {
  /// Things that rays in random directions saw; and those of them that belong to objects that are not listed.
  std::uint64_t rays = 0, missed_rays = 0;
  /// Objects that these rays, and as many aimed at random objects, saw from each cell; and those that are not listed.
  std::uint64_t objects = 0, missed_objects = 0;
  bool operator==(const HeldBack&) const = default;
};

/// What view cells see, as matrices of cells x objects. An object is seen, hidden (in neither matrix), or undecided
/// (not hidden, not seen). If a producer does not compute one of the two matrices, that matrix has no rows.
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

/// The same where columns are pairs of an object and one of its levels of detail: those that some cell lists.
struct LevelSight {
  std::vector<ObjectLevel> columns;  // ascending by object, then by level
  std::vector<Box> column_bounds;    // of the object at that level
  Sight sight;                       // matrices of cells x columns
};

}  // namespace vismat
