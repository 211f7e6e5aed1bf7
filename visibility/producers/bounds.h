// Lower and upper bounds of the visible set of each view cell: what shadows leave, and, if asked for, what rays prove seen.
#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "visibility/jobs/job_runner.h"
#include "visibility/producers/producers.h"
#include "visibility/rays/sampled.h"
#include "visibility/shadows/occluders.h"
#include "visibility/shadows/shadow.h"
#include "visibility/sight.h"
#include "visibility/view_cells.h"

namespace vismat {

/// How the bounds are found. Without rays only what is hidden is proven. With rays both are: sampling proves objects
/// seen that the shadows leave, and only the objects that are then undecided are examined further, by patches and rays
/// from them. (see_by_sampling casts rays alone.)
struct BoundsOptions {
  OccluderOptions occluders;
  ShadowOptions shadow;
  std::optional<SampledOptions> sampled;  // if absent, no object is proven seen
  std::uint64_t patch_rays = 0;           // from each patch, at objects still undecided; needs `sampled`
};

/// The options of the three efforts, which trade time for accuracy: 0 is one shadow view of each cell, from nine of its
/// points; 1 adds rays and some patches; 2 has many patches. Throws std::invalid_argument for other numbers.
BoundsOptions effort(unsigned level);
/// The bounds options of `options`: those of its effort, changed where an option is given; shadows alone, or with rays.
BoundsOptions bounds_options(const ProducerOptions& options, bool with_rays);

/// What the cells see. Sight::degree and Sight::lines are as see_by_sampling() gives them. The same scene, cells and
/// options give the same result with any JobRunner, on one kind of CPU.
Sight see_bounds(const Scene& scene, const ViewCells& cells, const BoundsOptions& options, JobRunner& runner,
                 const Stages& stages = {});
/// The same with shadows and rays that were made before, both of one scene; options.occluders is not used. `rays` may
/// be null without options.sampled.
Sight see_bounds(const Shadows& shadows, const AimedRays* rays, const ViewCells& cells,
                 const BoundsOptions& options, JobRunner& runner, const Stages& stages = {});

/// What looking from patches of a cell's surface decides about `candidates`, which the shadows of the whole cell leave,
/// as part of `around`. Without `rays` no object is proven seen. `number` is the cell's, for its own random numbers.
struct Decided {
  std::vector<std::uint32_t> undecided;  // ascending, as are the objects that are seen
  std::vector<SeenObject> seen;
  std::uint64_t rays = 0;
};
Decided decide_by_patches(Shadows::View& view, const AimedRays* rays, const BoundsOptions& options,
                          const Convex& cell, std::uint32_t number, std::span<const std::uint32_t> around,
                          std::span<const std::uint32_t> candidates);

/// The options in one line that names every parameter.
std::string describe(const BoundsOptions& options);

}  // namespace vismat
