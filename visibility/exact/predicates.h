// Exact geometric predicates: what crosses, meets or hides what, decided without rounding.
#pragma once
#include <array>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "visibility/geometry/convex.h"

namespace vismat {

// Every coordinate that is given to these functions must be finite; it is then taken as the rational number that it
// is, and the answers are exact. Most answers come from doubles with an error bound, the others from rational
// arithmetic.

using Triangle = std::array<glm::dvec3, 3>;

/// The sign of det(b - a, c - a, d - a): 1 if d lies on the side of a, b, c from which these run counter-clockwise.
int orientation(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const glm::dvec3& d);

/// A point inside the hull of `points`: their mean with these weights, which are not negative and not all 0. It can
/// name a point of a triangle that has no double coordinates.
struct WeightedMean {
  std::vector<glm::dvec3> points;
  std::vector<double> weights;
};

/// Whether the segment, without its ends, meets the triangle, with its border. A triangle without area meets nothing.
bool crosses(const glm::dvec3& from, const glm::dvec3& to, const Triangle& triangle);
/// The same for the surface of a solid, or for a flat polygon.
bool crosses(const glm::dvec3& from, const glm::dvec3& to, const Convex& convex);
/// The number of the first of `triangles` that the segment crosses; how many there are if it crosses none.
std::size_t first_crossed(const WeightedMean& from, const WeightedMean& to,
                          std::span<const Triangle> triangles);

/// Whether `convex` hides every point of the hull of `b` from every point of the hull of `a`: whether each segment
/// between one of the points `a` and one of the points `b` crosses it. That is enough. For a convex C and fixed w, the
/// points x for which w + t(x - w) is in C for some 0 < t < 1 are the union of w + s(C - w) over s > 1, which is
/// convex: the mean of s(c - w) and s'(c' - w) is again a number above 1 times a point of C, less w. So the vertices x
/// are enough for each vertex w and, with the ends exchanged, the vertices w for each x.
bool hides(const Convex& convex, std::span<const glm::dvec3> a, std::span<const glm::dvec3> b);

/// Whether some face of a solid that is not flat has all of `points` on or, if `strictly`, beyond its plane.
bool beyond_a_face(const Convex& solid, std::span<const glm::dvec3> points, bool strictly);

/// Whether a triangle and a closed solid have a point in common; the normals and offsets of its faces define the solid.
bool meets(const Triangle& triangle, const Convex& solid);

/// The triangles of the surface: the fan of each face, and for a flat polygon of both faces.
std::vector<Triangle> triangles_of(const Convex& convex);

}  // namespace vismat
