// The producer "sandwich": shadows, rays at what they leave, and then patches and rays for the undecided alone.
#include "visibility/producers/bounds.h"
#include "visibility/producers/producers.h"
#include "visibility/producers/see_levels.h"

namespace vismat {

Producer sandwich_producer() {
  using O = ProducerOptions;
  Producer producer;
  producer.name = "sandwich";
  producer.idea = "shadows, rays at what they leave, and patches and rays for what is then undecided";
  producer.guarantee = Guarantee::conservative;
  producer.seen_too = true;
  producer.options = {&O::effort,           &O::points, &O::patches,    &O::resolution,
                      &O::patch_resolution, &O::rays,   &O::patch_rays, &O::seed};
  producer.describe = [](const O& options) { return describe(bounds_options(options, true)); };
  producer.see = [](const Scene& scene, const ViewCells& cells, const O& options, JobRunner& runner,
                    const Stages& stages) {
    return see_bounds(scene, cells, bounds_options(options, true), runner, stages);
  };
  producer.see_levels = [](const Scene& scene, const LevelsOfDetail& levels, const ViewCells& cells,
                           const O& options, JobRunner& runner, const Stages& stages) {
    return see_levels(scene, levels, cells, bounds_options(options, true), runner, stages);
  };
  producer.describe_levels = [](const O& options, const Screen& screen) {
    return describe_levels(bounds_options(options, true), screen);
  };
  return producer;
}

}  // namespace vismat
