// Casts rays through a scene, by the library Embree.
#pragma once
#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <memory>
#include <vector>

#include "visibility/scene.h"

namespace vismat {

/// Where a ray first meets something: a triangle of the scene, and how far along the given direction.
struct Hit {
  static constexpr std::uint32_t nothing = 0xffffffff;
  std::uint32_t triangle = nothing;
  float distance = 0;  // in lengths of the direction
};

/// Casts rays through one scene. See-through objects (Scene::see_through) stop no ray: hits() ignores them, passed()
/// finds them. Watertight where triangles share vertices (Embree's robust mode); triangles are hit from both sides. A
/// caster may be shared by threads. The same rays give the same hits on one kind of CPU: Embree picks its code by the
/// instruction set.
class RayCaster {
 public:
  static constexpr unsigned width = 16;

  /// Throws std::runtime_error if Embree cannot start. Coordinates must be finite. Keeps no reference to the scene.
  explicit RayCaster(const Scene& scene);
  ~RayCaster();
  RayCaster(RayCaster&&) noexcept;
  RayCaster& operator=(RayCaster&&) noexcept;

  /// What the first `count` rays of a packet hit. `coherent` says that they start at one origin in similar directions,
  /// which makes them much faster.
  std::array<Hit, width> hits(const std::array<glm::vec3, width>& origins,
                              const std::array<glm::vec3, width>& directions, unsigned count,
                              bool coherent) const;
  Hit hit(const glm::vec3& origin, const glm::vec3& direction) const;

  /// Whether the scene has see-through triangles, so that passed() may find something.
  bool any_see_through() const;
  /// The see-through triangles that the ray meets within `distance` (as in Hit; infinite if nothing is hit), ascending.
  /// Together with the first opaque triangle these are all that is seen along the ray. Takes one ray at a time; costs
  /// nothing for a scene without see-through objects.
  std::vector<std::uint32_t> passed(const glm::vec3& origin, const glm::vec3& direction,
                                    float distance) const;

 private:
  struct Embree;
  std::unique_ptr<Embree> embree_;
};

}  // namespace vismat
