// Makes view cells of the ground on which viewers stand, as triangles, for any scene.
#pragma once
#include <optional>

#include "visibility/cells/free_space.h"
#include "visibility/scene.h"
#include "visibility/view_cells.h"

namespace vismat {

struct GroundCellsOptions {
  /// The ground is the plane at this height, over the region; by default it consists of the scene's walkable triangles.
  std::optional<float> height;
  float steepest = 40;  // degrees; steeper triangles are not walked on
  float step = 0.4f;    // metres that a viewer climbs; viewers stand on what is lower than that and walkable
  float radius = 0.1f;  // metres; viewers keep this far from obstacles, along x and along y
  float smallest = 0.1f;      // square metres; viewers do not stand on smaller pieces of one slope and height
  std::optional<Box> region;  // default: the scene's bounds
  Viewers viewers = {{}, {{1.6f, 1.6f}}};  // eyes above the ground
  unsigned threads = 0;                    // 0: one for each core; the cells are the same for any number
};

/// Prisms over triangles of the ground, with their neighbours (which share part of an edge, no more than a step apart
/// in height), in Z-order of the ground. The ground consists of the scene's triangles within the region that are no
/// steeper than `steepest`, on as many storeys as there are; triangles at one height are merged. Whatever is in the way
/// between the step's height and `radius` above the highest eyes is cut out, widened by `radius`; obstacles may be open
/// or closed, and their triangles may face either way. Of what is left, only what can be walked to is kept: from where
/// viewers start (the ground below each such point), otherwise from the largest connected ground under the sky, or from
/// the largest of all if none is under the sky. The same scene and options give the same cells, on one kind of CPU and
/// for one version of GEOS. Throws std::invalid_argument for options out of range, or if there is no ground, or none
/// below a start.
ViewCells make_ground_cells(const Scene& scene, const GroundCellsOptions& options = {});

}  // namespace vismat
