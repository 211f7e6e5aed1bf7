// Finds the supporting planes of a view cell and an occluder, which bound the occluder's umbra.
#pragma once
#include <glm/vec3.hpp>
#include <vector>

#include "visibility/geometry/convex.h"

namespace vismat {

/// Inside: dot(normal, x) >= offset; the normal has unit length.
struct Plane {
  glm::dvec3 normal{};
  double offset = 0;
};

/// True if some face of one has all of the other in front of it. They may touch: an eye is on no surface, so points of the cell
/// on an occluder do not count, and from all others every sight line to what lies behind passes through it. A flat occluder must
/// lie more than `gap` metres away from the cell, all of which is on one side of it. Not every pair that lies apart is found
/// so (two edges may keep them apart), which costs an occluder, never a visible object.
bool apart(const Convex& cell, const Convex& occluder, double gap, bool flat);

/// Facets of the convex hull of both that touch both (without those through an edge of the cell if the occluder is flat:
/// they bound no umbra there), both lying inside of each plane. Between them and behind the occluder lies its umbra: the
/// points that no segment from the cell reaches without meeting it. Needs apart(). Adds to `planes`, of
/// which those from `first` on are taken to belong to the same pair. O(edges * vertices).
void supporting_planes(const Convex& cell, const Convex& occluder, bool flat, std::vector<Plane>& planes,
                       std::size_t first = 0);

}  // namespace vismat
