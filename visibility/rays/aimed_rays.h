// Casts rays from one view cell at given objects.
#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "matrix/base/random.h"
#include "visibility/geometry/cell_points.h"
#include "visibility/rays/ray_caster.h"
#include "visibility/scene.h"
#include "visibility/sight.h"

namespace vismat {

/// An object that a ray from a view cell reached first, and that ray.
struct SeenObject {
  std::uint32_t object = 0;
  SightLine line;
  bool operator==(const SeenObject&) const = default;
};

/// Finds objects that are seen from a view cell; it may miss some, and never invents one. Every sight line was traced
/// as it is given: the first thing on the way from `from` to `to` is the object, at `to` except for rounding. May be
/// shared by threads.
class AimedRays {
 public:
  /// Borrows scene and caster. O(triangles).
  AimedRays(const Scene& scene, const RayCaster& caster);
  /// The same with another caster, which it borrows: one for the scene of some of the objects. Shares all else. `targets`
  /// and `hints` must then be among these objects.
  AimedRays with(const RayCaster& caster) const;

  /// The objects that were seen, ascending and each once, and the number of rays that were cast.
  struct Seen {
    std::vector<SeenObject> objects;
    std::uint64_t rays = 0;
  };
  /// Which of `targets` (ascending, each once) are seen. First come those that touch the cell (from == to), then at
  /// most `rays` rays are cast at those that are not seen yet. `hints` are sight lines from other places to some of the
  /// targets. The same arguments give the same answer.
  Seen from(const CellPoints& cell, std::span<const std::uint32_t> targets, std::uint64_t rays, Random random,
            std::span<const SeenObject> hints = {}) const;

  /// Traces the sight line again: whether the object is the first thing on it, except for see-through things, and lies
  /// at its end.
  bool confirms(const SeenObject& seen) const;
  /// A random point of an object that has some area, about uniform by area.
  glm::vec3 point_of(std::uint32_t object, Random& random) const;
  bool has_area(std::uint32_t object) const {
    return aims_->first_patch[object] < aims_->first_patch[object + 1];
  }

  const Scene& scene() const { return scene_; }
  const RayCaster& caster() const { return caster_; }
  const std::vector<Box>& bounds() const { return aims_->bounds; }  // of the objects

 private:
  glm::vec3 extreme_of(std::uint32_t object, Random& random) const;
  glm::dvec3 beside(std::uint32_t object, Random& random) const;
  std::optional<glm::vec3> touch(const CellPoints& cell, const Box& box, std::uint32_t object) const;

  struct Aims {
    explicit Aims(const Scene& scene);
    std::vector<Box> bounds;
    // The items of an object lie together; those of object o begin at first_...[o]. Each of these arrays has objects + 1
    // numbers.
    ObjectTriangles triangles;
    std::vector<std::uint64_t> first_patch, first_extreme;
    std::vector<std::array<glm::vec3, 3>> patches;  // some of its triangles, evenly by area
    /// Vertices that lie farthest out, each with the middle of its triangle.
    std::vector<std::array<glm::vec3, 2>> extremes;
  };
  AimedRays(const Scene& scene, const RayCaster& caster, std::shared_ptr<const Aims> aims);

  const Scene& scene_;
  const RayCaster& caster_;
  std::shared_ptr<const Aims> aims_;
};

}  // namespace vismat
