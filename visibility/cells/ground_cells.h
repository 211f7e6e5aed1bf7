// Makes view cells of the ground on which viewers stand, as triangles, for any scene.
#pragma once
#include <optional>

#include "visibility/cells/free_space.h"
#include "visibility/scene.h"
#include "visibility/view_cells.h"

namespace vismat {

struct GroundCellsOptions {
  /// The ground is the plane at this height, over the region; default: it is what the scene has of walkable triangles.
  std::optional<float> height;
  float steepest = 40;  // degrees; steeper triangles are not walked on
  float step = 0.4f;    // metres up that a viewer climbs; what is lower than that and walkable is stood upon
  float radius = 0.1f;  // metres; viewers keep this far from obstacles, along x and along y
  float smallest = 0.1f;      // square metres; what is smaller at one slope and height is not stood upon
  std::optional<Box> region;  // default: the scene's bounds
  Viewers viewers = {{}, {{1.6f, 1.6f}}};  // eyes above the ground
  unsigned threads = 0;                    // 0: one a core; the cells are the same for any number
};

/// Prisms over triangles of the ground, with their neighbours (which share part of an edge, no more than a step apart), in
/// Z-order of the ground. Ground are the triangles of the scene within the region that are no steeper than told, on as many
/// storeys as there are; those at one height are merged. Cut out of it, radius included, is all that is in the way between
/// the step's height and `radius` above the highest eyes; obstacles may be open or closed and turned either way. Of what is
/// left only what can be walked to is kept: from where viewers start (the ground below each such point), otherwise from the
/// largest connected ground under the sky, or the largest of all where no ground is under the sky. Same scene and options,
/// same cells, on one kind of CPU and for one version of GEOS. Throws std::invalid_argument for options out of range, where
/// there is no ground, or none below a start.
ViewCells make_ground_cells(const Scene& scene, const GroundCellsOptions& options = {});

}  // namespace vismat
