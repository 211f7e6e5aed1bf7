// Casts rays through a scene, by the library Embree.
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <memory>
#include <span>
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

  /// How long to prepare: `fast_rays` takes three times as long as `soon`, after which each ray is a little faster. Both
  /// give the same hits, except where two triangles are met at one distance.
  enum class Preparation { fast_rays, soon };

  /// Throws std::runtime_error if Embree cannot start. Coordinates must be finite. Keeps no reference to the scene.
  explicit RayCaster(const Scene& scene, Preparation preparation = Preparation::fast_rays);
  ~RayCaster();
  RayCaster(RayCaster&&) noexcept;
  RayCaster& operator=(RayCaster&&) noexcept;

  /// What the first `count` rays of a packet hit. `coherent` says that they start at one origin in similar directions,
  /// which makes them much faster.
  std::array<Hit, width> hits(const std::array<glm::vec3, width>& origins,
                              const std::array<glm::vec3, width>& directions, unsigned count,
                              bool coherent) const;
  Hit hit(const glm::vec3& origin, const glm::vec3& direction) const;
  /// The first of the opaque triangles that `shown` allows, as if there were no others. `shown` is called for some of
  /// the triangles on the ray's way, in any order.
  Hit hit_of(const glm::vec3& origin, const glm::vec3& direction,
             const std::function<bool(std::uint32_t triangle)>& shown) const;

  /// Whether the scene has see-through triangles, so that passed() may find something.
  bool any_see_through() const;
  /// The see-through triangles that the ray meets within `distance` (as in Hit; infinite if nothing is hit), ascending.
  /// Together with the first opaque triangle these are all that is seen along the ray. Takes one ray at a time; costs
  /// nothing for a scene without see-through objects.
  std::vector<std::uint32_t> passed(const glm::vec3& origin, const glm::vec3& direction,
                                    float distance) const;

 private:
  friend class PartCasters;
  struct Embree;
  explicit RayCaster(std::unique_ptr<Embree> embree);
  std::unique_ptr<Embree> embree_;
};

/// Makes casters for the scenes that have only some of a scene's objects: each object's triangles are prepared once, and
/// a caster then takes little more time than a tree over the objects. Its rays take about half as long again. May be
/// shared by threads.
class PartCasters {
 public:
  /// Throws as RayCaster does. Keeps no reference to the scene.
  explicit PartCasters(const Scene& scene);
  ~PartCasters();

  /// A caster for the scene of these objects alone (each once). Hits name triangles of the whole scene. It may outlive
  /// this.
  RayCaster among(std::span<const std::uint32_t> objects) const;

 private:
  struct Prepared;
  std::shared_ptr<const Prepared> prepared_;
};

}  // namespace vismat
