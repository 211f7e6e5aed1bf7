// Makes flat occluders, which are convex polygons, from the flat faces of an object.
#pragma once
#include <span>

#include "visibility/geometry/mesh.h"
#include "visibility/shadows/coplanar.h"
#include "visibility/shadows/occluder_maker.h"

namespace vismat {

/// Keeps the largest convex polygons in the faces of `mesh`, none of them smaller than `least_area`.
void add_polygons(OccluderMaker& maker, const Mesh& mesh, std::span<const CoplanarFace> faces,
                  double least_area);

}  // namespace vismat
