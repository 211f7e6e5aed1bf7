// Finds the supporting planes of a view cell and an occluder, which bound the occluder's umbra.
#pragma once
#include <glm/vec3.hpp>
#include <vector>

#include "visibility/geometry/convex.h"

namespace vismat {

/// A plane, whose inside is dot(normal, x) >= offset; the normal has unit length.
struct Plane {
  glm::dvec3 normal{};
  double offset = 0;
};

/// Whether some face of one has all of the other in front of it. They may touch: an eye is never on a surface, so
/// points of the cell on an occluder do not count, and from all others every sight line to what lies behind the
/// occluder passes through it. A flat occluder must lie more than `gap` metres away from the cell, all of which is on
/// one side of it. Some pairs that lie apart are not found in this way (two edges may keep them apart), which costs an
/// occluder, never a visible object.
bool apart(const Convex& cell, const Convex& occluder, double gap, bool flat);

/// Appends to `planes` the planes of those facets of the convex hull of both that touch both, with both inside each
/// plane (without facets through an edge of the cell if the occluder is flat: they bound no umbra there). Between them
/// and behind the occluder lies its umbra: the points that no segment from the cell reaches without meeting the
/// occluder. Needs apart(). The planes from `first` on are taken to belong to the same pair. O(edges * vertices).
void supporting_planes(const Convex& cell, const Convex& occluder, bool flat, std::vector<Plane>& planes,
                       std::size_t first = 0);

}  // namespace vismat
