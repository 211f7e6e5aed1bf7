// Makes solid occluders from the closed parts of an object.
#pragma once
#include <span>

#include "visibility/geometry/mesh.h"
#include "visibility/shadows/coplanar.h"
#include "visibility/shadows/occluder_maker.h"

namespace vismat {

/// Keeps the closed part as a solid if it is convex, and returns how often it winds around its middle; 0 if it is not
/// convex. `faces` are the part's coplanar faces.
int add_convex(OccluderMaker& maker, const Mesh& part, std::span<const CoplanarFace> faces);

/// Keeps boxes inside the closed parts, taken together, axis-aligned or turned about z. Returns the area of the largest
/// of the boxes' sides.
double add_boxes(OccluderMaker& maker, const Mesh& closed);

}  // namespace vismat
