// Makes solid occluders of the closed parts of an object.
#pragma once
#include <span>

#include "visibility/geometry/mesh.h"
#include "visibility/shadows/coplanar.h"
#include "visibility/shadows/occluder_maker.h"

namespace vismat {

/// If the closed part is convex, keeps it as a solid, and tells how often it winds round its middle; 0 if it is not. `faces`
/// are the part's coplanar faces.
int add_convex(OccluderMaker& maker, const Mesh& part, std::span<const CoplanarFace> faces);

/// Keeps boxes inside the closed parts, taken together, axis-aligned or turned about z; returns the area of the largest of
/// their sides.
double add_boxes(OccluderMaker& maker, const Mesh& closed);

}  // namespace vismat
