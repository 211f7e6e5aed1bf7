// Checks the proofs that producers give for their entries, in rational arithmetic.
#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "matrix/base/random.h"
#include "visibility/exact/predicates.h"
#include "visibility/scene.h"
#include "visibility/shadows/occluders.h"
#include "visibility/shadows/shadow.h"
#include "visibility/sight.h"

namespace vismat {

/// Why a proof does not hold; none if it does.
using Doubt = std::optional<std::string>;

/// Checks proofs. May be shared by threads. Answers depend only on the scene and the arguments. Each check looks
/// through the boxes of all objects and the triangles of those near the segment.
class WitnessCheck {
 public:
  explicit WitnessCheck(const Scene& scene);  // borrows it

  /// Whether the cell sees the object along the line. Both ends may be off by the rounding of floats: eight units in
  /// the last place of the largest coordinate, so `from` may lie that far outside the cell. `to` is moved to the
  /// nearest rational point of the object's triangles, and no opaque triangle of another object may be crossed on the
  /// way (without the ends, with the triangles' borders). If one is crossed, points up to 1/256 of a triangle away are
  /// tried: a line that passes an edge at less than the rounding proves as much from there; `aimed_again` counts these.
  /// A line without length claims that the two touch. If they do, nothing more is asked; if only rounding keeps them
  /// apart, the line is checked like any other.
  Doubt seen(const Convex& cell, std::uint32_t object, const SightLine& line,
             std::uint64_t* aimed_again = nullptr) const;

  /// Whether the witness proves the object hidden from the cell. This is tested at `samples` points of the object, half
  /// of which are vertices that lie farthest out. For each part that has the point beyond its plane, one of the part's
  /// occluders must hide the point from all of the patch (exact for the point as doubles, since the patch's corners are
  /// enough), and the sight lines from the corners and from a random point of the patch must cross triangles of the
  /// occluder's object (exact). Random points of the cell's faces that have the sample in front must lie in the patch
  /// of some part, within 1e-9 of the coordinates. A border of 2^-30 of each patch is left out: where a cell touches a
  /// solid's edge, only that edge sees past the solid. Samples prove nothing about the points between them. An object
  /// without triangles is hidden.
  Doubt hidden(const Convex& cell, std::uint32_t object, const HiddenWitness& witness,
               std::span<const Occluder> occluders, std::uint32_t samples, Random random) const;

 private:
  Triangle corners(std::uint32_t triangle) const;
  glm::dvec3 farthest_vertex(std::uint32_t object, const glm::dvec3& direction) const;
  bool crosses_one_of(std::uint32_t object, const WeightedMean& from, const WeightedMean& to) const;
  std::optional<std::uint32_t> in_between(std::uint32_t object, const WeightedMean& from,
                                          const WeightedMean& to) const;

  const Scene& scene_;
  std::vector<Box> bounds_;
  ObjectTriangles triangles_;
};

}  // namespace vismat
