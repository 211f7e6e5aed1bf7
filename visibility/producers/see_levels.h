// Finds what view cells see of a scene whose objects are at levels of detail that each cell allows.
#pragma once
#include <string>

#include "visibility/detail/levels_of_detail.h"
#include "visibility/jobs/job_runner.h"
#include "visibility/producers/bounds.h"
#include "visibility/scene.h"
#include "visibility/sight.h"
#include "visibility/view_cells.h"

namespace vismat {

/// The vLOD of each cell [Chhugani et al. 2005, sections 4 and 5]: the objects are at the levels that
/// LevelsOfDetail::level_for() chooses for the cell's bounding box, and visibility is that of scene_at() with these
/// levels, whose objects are both what hides and what is hidden. Objects of which no triangle may face the cell are left
/// out. A cell lists each object at one level at most.
///
/// The bounds are found as see_bounds() finds them, but for each cell by itself: rays of one cell prove nothing for
/// others, since these see another scene. So there is one round of rays (options.sampled->rounds is not used). The same
/// arguments give the same result with any JobRunner, on one kind of CPU. `levels` must be those of the scene. Memory is
/// about 0.5 kB for each triangle of all levels together.
LevelSight see_levels(const Scene& scene, const LevelsOfDetail& levels, const ViewCells& cells,
                      const BoundsOptions& options, JobRunner& runner, const Stages& stages = {});

/// The options in one line that names every parameter; `screen` is that for which the levels are made.
std::string describe_levels(const BoundsOptions& options, const Screen& screen);

}  // namespace vismat
