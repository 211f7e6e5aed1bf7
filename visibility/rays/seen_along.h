// Finds what rays see: the first thing that stops them, and what is see-through before it.
#pragma once
#include <algorithm>
#include <array>
#include <glm/geometric.hpp>

#include "visibility/rays/ray_caster.h"
#include "visibility/scene.h"

namespace vismat {

/// Casts a packet as RayCaster::hits() does and returns the hits. Calls found(ray, triangle, distance) for each
/// see-through triangle before a hit, and then for the hit itself.
template <typename Found>
std::array<Hit, RayCaster::width> see_along(const Scene& scene, const RayCaster& caster,
                                            const std::array<glm::vec3, RayCaster::width>& origins,
                                            const std::array<glm::vec3, RayCaster::width>& directions,
                                            unsigned count, bool coherent, const Found& found) {
  const auto hits = caster.hits(origins, directions, count, coherent);
  for (unsigned ray = 0; ray < count; ++ray) {
    for (const std::uint32_t triangle : caster.passed(origins[ray], directions[ray], hits[ray].distance)) {
      const auto [a, b, c] = corners_of<glm::dvec3>(scene, triangle);
      const glm::dvec3 normal = glm::cross(b - a, c - a);
      const double distance =
          glm::dot(normal, a - glm::dvec3(origins[ray])) / glm::dot(normal, glm::dvec3(directions[ray]));
      if (distance >= 0 && distance <= hits[ray].distance) found(ray, triangle, static_cast<float>(distance));
    }
    if (hits[ray].triangle != Hit::nothing) found(ray, hits[ray].triangle, hits[ray].distance);
  }
  return hits;
}

}  // namespace vismat
