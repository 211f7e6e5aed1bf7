// Finds occluders: convex pieces of a scene that no sight line passes.
#pragma once
#include <cstdint>
#include <memory>
#include <vector>

#include "visibility/geometry/convex.h"
#include "visibility/geometry/mesh.h"
#include "visibility/geometry/point_bounds.h"
#include "visibility/scene.h"

namespace vismat {

/// A closed surface and the box around it.
struct Enclosure {
  Mesh surface;
  Bounds bounds;
};

/// A convex shape that blocks the view: every segment from a point of a cell that blocks_from() allows, through
/// `shape`, to a point beyond it crosses a triangle of the object before it leaves the shape.
struct Occluder {
  Convex shape;
  std::uint32_t object = 0;  // to which it belongs
  bool flat = false;         // a polygon; otherwise a solid
  /// The closed surface around a solid that does not fill it. Sight lines cross that surface, so nothing blocks those
  /// that begin inside it. Null if the solid fills its surface, or the occluder is flat.
  std::shared_ptr<const Enclosure> within{};
  /// If above 0, the triangles are flat only up to rounding. Only those sight lines are blocked that begin at least
  /// this far above the plane for each metre to the polygon's farthest corner.
  double grazing = 0;
  /// Whether the polygon lies behind all of the triangles, so that it blocks only for cells on the side of faces[0].
  bool one_sided = false;
};

struct OccluderOptions {
  std::uint32_t boxes_per_object = 8;      // at most, inside a closed object that is not convex
  std::uint32_t polygons_per_object = 64;  // at most, the largest ones; in objects that are not closed
  float smallest = 0.5f;  // metres; occluders that are narrower along their second longest side are left out
  /// Solids with vertical sides that stand on the scene's lowest plane reach far below it. Use this only for view cells
  /// that have no point below lowest_point(): all sight lines then stay above, so a sight line that meets the extension
  /// meets the solid too.
  bool extend_below_ground = true;
  unsigned threads = 0;  // 0: one for each core
};

/// The lowest z of all triangles; 0 for a scene without triangles.
float lowest_point(const Scene& scene);

/// Finds the occluders of each object, from its triangles with vertices joined that are equal bit for bit, whichever
/// way they face, for each part that sides connect. They are: a closed and convex part (whose faces may be tessellated)
/// as one solid; the largest boxes inside other closed parts, axis-aligned or turned about z; the largest convex
/// polygons of the flat faces of what is not closed, and of closed parts those faces that are larger than any side of
/// their boxes. Objects that are see-through, or not finite, have none. Ascending by object. Deterministic.
///
/// Sound by one lemma: a convex shape whose interior no triangle of a closed surface enters, and around one point of
/// which the surface winds, lies inside the surface; for polygons the same holds one dimension lower, with the face's
/// outline. Both conditions are tested against all triangles in the end, whatever search gave the shape. Shapes that
/// are found by rounded arithmetic are shrunk by more than the rounding.
std::vector<Occluder> find_occluders(const Scene& scene, const OccluderOptions& options = {});

/// Whether every sight line that begins in `cell` and passes through the shape is blocked by the occluder's object.
/// Shape and cell must also be disjoint, and for a flat occluder the cell must lie strictly on one side: this is left
/// to the caller. Conservative; the cell counts as its bounding box. O(1), except for cells whose box meets the
/// enclosure's: O(its triangles).
bool blocks_from(const Occluder& occluder, const Convex& cell);

}  // namespace vismat
