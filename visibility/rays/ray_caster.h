// Casts rays through a scene, by Embree.
#pragma once
#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <memory>
#include <vector>

#include "visibility/scene.h"

namespace vismat {

/// Where a ray first meets something: a triangle of the scene, and how far along the direction given.
struct Hit {
  static constexpr std::uint32_t nothing = 0xffffffff;
  std::uint32_t triangle = nothing;
  float distance = 0;  // in lengths of the direction
};

/// See-through objects (Scene::see_through) stop no ray: hits() passes them by, passed() tells of them.
/// Watertight where triangles share vertices (Embree's robust mode); triangles are hit from both sides. One may be shared by
/// threads. Same rays, same hits, on one kind of CPU: Embree picks its code by the instruction set.
class RayCaster {
 public:
  static constexpr unsigned width = 16;

  /// Throws std::runtime_error if Embree cannot start. Coordinates must be finite. Keeps no reference to the scene.
  explicit RayCaster(const Scene& scene);
  ~RayCaster();
  RayCaster(RayCaster&&) noexcept;
  RayCaster& operator=(RayCaster&&) noexcept;

  /// The first `count` rays of a packet; coherent ones from one origin run up to seven times faster than others.
  std::array<Hit, width> hits(const std::array<glm::vec3, width>& origins,
                              const std::array<glm::vec3, width>& directions, unsigned count,
                              bool coherent) const;
  Hit hit(const glm::vec3& origin, const glm::vec3& direction) const;

  /// Whether passed() can find anything.
  bool any_see_through() const;
  /// The see-through triangles that the ray meets within `distance` (as in Hit, infinite where there is none), ascending: with
  /// the first opaque one, all that is seen along it. One ray at a time; for a scene that has none, free.
  std::vector<std::uint32_t> passed(const glm::vec3& origin, const glm::vec3& direction,
                                    float distance) const;

 private:
  struct Embree;
  std::unique_ptr<Embree> embree_;
};

}  // namespace vismat
