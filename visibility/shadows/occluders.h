// Finds occluders: convex pieces of a scene that no sight line passes through.
#pragma once
#include <cstdint>
#include <memory>
#include <vector>

#include "visibility/geometry/bounds.h"
#include "visibility/geometry/convex.h"
#include "visibility/geometry/mesh.h"
#include "visibility/scene.h"

namespace vismat {

/// A closed surface, and the box around it.
struct Enclosure {
  Mesh surface;
  Bounds bounds;
};

/// Every segment from a point of a cell that blocks_from() allows, through `shape`, to a point beyond it crosses a triangle of
/// the object before it leaves the shape.
struct Occluder {
  Convex shape;
  std::uint32_t object = 0;  // whose it is
  bool flat = false;         // a polygon; otherwise a solid
  /// A solid that does not fill the closed surface it lies in, which is what sight lines cross: nothing blocks those that
  /// begin inside. Null: it fills it, or is flat.
  std::shared_ptr<const Enclosure> within{};
  /// Above 0: the triangles are flat only up to rounding. Only sight lines are blocked that begin at least this far above the
  /// plane for each metre to the polygon's farthest corner.
  double grazing = 0;
  /// The polygon lies behind all of the triangles: it blocks only for cells on the side of faces[0].
  bool one_sided = false;
};

struct OccluderOptions {
  std::uint32_t boxes_per_object = 8;      // at most, inside a closed object that is not convex
  std::uint32_t polygons_per_object = 64;  // at most, the largest; of what is not closed
  float smallest = 0.5f;  // metres; occluders that are narrower along their second longest side are left out
  /// What stands on the scene's lowest plane with vertical sides reaches far below it. Only for view cells of which no point
  /// is below lowest_point(): all sight lines then stay above, so what hits the addition hits what stands on it.
  bool extend_below_ground = true;
  unsigned threads = 0;  // 0: one a core
};

/// The least z of all triangles; 0 for a scene without any.
float lowest_point(const Scene& scene);

/// Per object, from its triangles with vertices joined that are equal bit for bit, whichever way they are turned, for each
/// part that sides connect: closed and convex parts (faces may be tessellated) as one solid; the largest boxes
/// inside other closed ones, axis-aligned or turned about z; the largest convex polygons of flat faces of what is not closed,
/// and of closed parts faces that are larger than any side of their boxes. Objects that are see-through, or not finite, have
/// none. Ascending by object. Deterministic.
///
/// Sound by one lemma: a convex shape whose interior no triangle of a closed surface enters, and round one point of which the
/// surface winds, lies inside; for polygons the same one dimension lower, with the face's outline. Both are tested against
/// all triangles in the end, whatever search gave the shape. Shapes found by rounded arithmetic are shrunk by more than the
/// rounding.
std::vector<Occluder> find_occluders(const Scene& scene, const OccluderOptions& options = {});

/// Whether every sight line that begins in `cell` and passes through the shape is blocked by the occluder's object. Shape and
/// cell must also be disjoint, and for flat ones the cell strictly on one side: that is left to the caller. Conservative; the
/// cell counts as its bounding box. O(1) but for cells whose box meets the enclosure's: O(its triangles).
bool blocks_from(const Occluder& occluder, const Convex& cell);

}  // namespace vismat
