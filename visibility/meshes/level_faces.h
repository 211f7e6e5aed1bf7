// Tells which way up a scene probably is.
#pragma once
#include "visibility/scene.h"

namespace vismat {

/// The axis (0 x, 1 y, 2 z) along which most level faces look; z unless another one has twice as much. Counted is the largest
/// area that lies in one plane across an axis, which is the ground in most scenes; or, where no plane holds a twentieth of all,
/// the area as it is seen along each axis, which is largest from above for terrain. O(n log n) for n triangles.
int axis_of_level_faces(const Scene& scene);

}  // namespace vismat
