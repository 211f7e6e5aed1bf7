// Casts rays from one view cell at given objects.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "matrix/base/random.h"
#include "visibility/geometry/cell_points.h"
#include "visibility/rays/ray_caster.h"
#include "visibility/scene.h"
#include "visibility/sight.h"

namespace vismat {

/// An object that a ray from a view cell reached first.
struct SeenObject {
  std::uint32_t object = 0;
  SightLine line;
  bool operator==(const SeenObject&) const = default;
};

/// Finds objects that are seen from a view cell; may miss some, and never invents one. Every sight line was traced as it is given: the first
/// thing on the way from `from` to `to` is the object, at `to` but for rounding. May be shared by threads.
class AimedRays {
 public:
  /// Borrows both. O(triangles).
  AimedRays(const Scene& scene, const RayCaster& caster);

  /// Ascending by object, none twice. `rays` is how many were cast.
  struct Seen {
    std::vector<SeenObject> objects;
    std::uint64_t rays = 0;
  };
  /// Which of `targets` (ascending, none twice) are seen: first what touches the cell (from == to), then by at most `rays` rays
  /// at those not seen yet. `hints`: sight lines from other places at some of the targets. Same arguments, same answer.
  Seen from(const CellPoints& cell, std::span<const std::uint32_t> targets, std::uint64_t rays, Random random,
            std::span<const SeenObject> hints = {}) const;

  /// Traces it again: the object is the first thing on its sight line, but for what is see-through, and lies at its end.
  bool confirms(const SeenObject& seen) const;
  /// About uniform by area, of an object that has some.
  glm::vec3 point_of(std::uint32_t object, Random& random) const;
  bool has_area(std::uint32_t object) const { return first_patch_[object] < first_patch_[object + 1]; }

  const Scene& scene() const { return scene_; }
  const RayCaster& caster() const { return caster_; }
  const std::vector<Box>& bounds() const { return bounds_; }  // of the objects

 private:
  glm::vec3 extreme_of(std::uint32_t object, Random& random) const;
  glm::dvec3 beside(std::uint32_t object, Random& random) const;
  std::optional<glm::vec3> touch(const CellPoints& cell, const Box& box, std::uint32_t object) const;

  const Scene& scene_;
  const RayCaster& caster_;
  std::vector<Box> bounds_;
  // What belongs to an object lies together; object o's begins at first_..._[o], objects + 1 of each.
  ObjectTriangles triangles_;
  std::vector<std::uint64_t> first_patch_, first_extreme_;
  std::vector<std::array<glm::vec3, 3>> patches_;  // some of its triangles, evenly by area
  /// A vertex that lies farthest out, and the middle of its triangle.
  std::vector<std::array<glm::vec3, 2>> extremes_;
};

}  // namespace vismat
