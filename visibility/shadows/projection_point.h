// Chooses the point of a view cell from which its occluders are best projected.
#pragma once
#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <span>

#include "visibility/shadows/occluders.h"
#include "visibility/shadows/supporting_planes.h"

namespace vismat {

/// How an occluder shrinks, seen from a point v of the cell: to s = (dot(normal, v) - plane) / (apex - plane) of its
/// size.
struct Shrinkage {
  /// Unit length, towards the cell. Of a solid it is the mean of the faces that see all of the cell.
  glm::dvec3 normal{};
  double plane = 0;   // dot(normal, x) where the occluder is
  double apex = 0;    // and at the farthest point between its supporting planes, where s is 1
  double weight = 0;  // solid angle, seen from the cell's middle
};

/// How the occluder shrinks. Nothing if its shrunk copy does not stay around its middle (as for those that are smaller
/// than the cell), if its supporting planes do not meet on the cell's side, or if there are more than 16 planes to
/// search. O(planes^4) small steps.
std::optional<Shrinkage> shrinkage(const Convex& cell, const Occluder& occluder,
                                   std::span<const Plane> supporting);

enum class ProjectionObjective {
  /// The least sum of squared distances (apex - dot(normal, v))^2 [Chhugani et al. 2005, section 5.2], a convex
  /// problem, by NLopt's sequential quadratic programming. The paper looks for v between all supporting planes; the
  /// cell is part of that region.
  apexes,
  /// The largest sum of weight * s^2, which measures what the shrunk occluders cover (ours). Convex too, but to be
  /// maximised: the best point is a vertex of the cell, so all vertices are tried.
  areas,
};

/// The best point of the cell; the centre if there is nothing to choose by. Any point gives conservative results.
/// Deterministic.
glm::dvec3 projection_point(const Convex& cell, std::span<const Shrinkage> occluders,
                            ProjectionObjective objective);

/// The objective's sum at the point.
double value_of(const glm::dvec3& point, std::span<const Shrinkage> occluders, ProjectionObjective objective);

}  // namespace vismat
