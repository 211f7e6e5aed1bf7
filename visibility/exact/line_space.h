// Decides exactly whether an object is visible from a view cell, by branch and bound over lines, for small scenes.
#pragma once
#include <cstdint>
#include <optional>
#include <span>

#include "visibility/exact/predicates.h"
#include "visibility/scene.h"
#include "visibility/shadows/occluders.h"

namespace vismat {

enum class Visibility { hidden, visible, undecided };

struct LineSpaceAnswer {
  Visibility visibility = Visibility::undecided;
  /// If visible: a point of the cell's border and one of the object; none where cell and object meet.
  std::optional<std::array<glm::dvec3, 2>> sight_line;
  std::uint64_t pieces = 0;  // pairs of triangles looked at
};

/// Visible: some segment from the cell to the object crosses no opaque triangle of another object (as crosses() has it: ends
/// left out, borders included), or the two meet. Hidden: all are crossed by one of `occluders` of other objects, which may be
/// hand-made. Both answers are exact; undecided after `most_pieces` pairs, or where a midpoint is no double any more. Each
/// occluder must be sound as find_occluders promises; with none, nothing can be found hidden.
/// For tens of occluders: each pair of triangles is tried against those whose boxes lie near it.
LineSpaceAnswer look_in_line_space(const Scene& scene, std::span<const Occluder> occluders,
                                   const Convex& cell, std::uint32_t object,
                                   std::uint64_t most_pieces = 1 << 16);

}  // namespace vismat
