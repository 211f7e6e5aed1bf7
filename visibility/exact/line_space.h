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
  /// If the object is visible: a point of the cell's surface and one of the object; none if cell and object meet.
  std::optional<std::array<glm::dvec3, 2>> sight_line;
  std::uint64_t pieces = 0;  // pairs of triangles that were examined
};

/// Whether the object is visible from the cell. Visible: some segment from the cell to the object crosses no opaque
/// triangle of another object (as crosses() defines it: without the segment's ends, with the triangle's border), or the
/// two meet. Hidden: every such segment is crossed by one of the `occluders` that belong to other objects; they may be
/// made by hand. Both answers are exact. Undecided: `most_pieces` pairs were examined, or a midpoint is no longer a
/// double. Each occluder must keep the promise of find_occluders; without occluders nothing is found hidden. Made for
/// tens of occluders: each pair of triangles is tried against those whose boxes lie near it.
LineSpaceAnswer look_in_line_space(const Scene& scene, std::span<const Occluder> occluders,
                                   const Convex& cell, std::uint32_t object,
                                   std::uint64_t most_pieces = 1 << 16);

}  // namespace vismat
