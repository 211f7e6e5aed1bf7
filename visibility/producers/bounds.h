// Bounds on what each view cell of a scene sees: what shadows prove hidden and, if wanted, what rays prove seen.
#pragma once
#include <cstdint>
#include <optional>
#include <string>

#include "visibility/jobs/job_runner.h"
#include "visibility/producers/producers.h"
#include "visibility/rays/sampled.h"
#include "visibility/shadows/occluders.h"
#include "visibility/shadows/shadow.h"
#include "visibility/sight.h"
#include "visibility/view_cells.h"

namespace vismat {

/// Without rays: conservative, proves what is hidden. With rays, a sandwich: sampling proves what of the rest is seen, and only what is
/// undecided then is refined, by patches and rays from them. (Rays alone: see_by_sampling.)
struct BoundsOptions {
  OccluderOptions occluders;
  ShadowOptions shadow;
  std::optional<SampledOptions> sampled;  // nothing: no object is proven seen
  std::uint64_t patch_rays = 0;           // a patch, at what is undecided from there; needs `sampled`
};

/// Time for accuracy, in three steps: 0 is one shadow view a cell, from nine of its points; 1 a sandwich with some patches; 2 with
/// many, about 8, 120 and 950 ms a cell of a city of a million triangles. Throws std::invalid_argument for others.
BoundsOptions effort(unsigned level);
/// What `options` make of the effort that they name: shadows alone, or a sandwich.
BoundsOptions bounds_options(const ProducerOptions& options, bool with_rays);

/// Sight::degree and Sight::lines as see_by_sampling() gives them. Same scene, cells and options, same result, for any JobRunner, on one kind of CPU.
Sight see_bounds(const Scene& scene, const ViewCells& cells, const BoundsOptions& options, JobRunner& runner,
                 const Stages& stages = {});
/// The same with what was made before, of one scene; options.occluders is not looked at. `rays` may be null without
/// options.sampled.
Sight see_bounds(const Shadows& shadows, const AimedRays* rays, const ViewCells& cells,
                 const BoundsOptions& options, JobRunner& runner, const Stages& stages = {});

/// One line that names every parameter.
std::string describe(const BoundsOptions& options);

}  // namespace vismat
