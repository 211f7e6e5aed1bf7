// The producer "shadow": hidden is what lies in an occluder's shadow, from the whole cell or from every patch of its surface.
#include "visibility/producers/bounds.h"
#include "visibility/producers/producers.h"
#include "visibility/producers/see_levels.h"

namespace vismat {

Producer shadow_producer() {
  using O = ProducerOptions;
  Producer producer;
  producer.name = "shadow";
  producer.idea = "shrunk shadows of single occluders, joined over patches of the view cell's surface";
  producer.guarantee = Guarantee::conservative;
  producer.options = {&O::effort, &O::points, &O::patches, &O::resolution, &O::patch_resolution};
  producer.describe = [](const O& options) { return describe(bounds_options(options, false)); };
  producer.see = [](const Scene& scene, const ViewCells& cells, const O& options, JobRunner& runner,
                    const Stages& stages) {
    return see_bounds(scene, cells, bounds_options(options, false), runner, stages);
  };
  producer.see_levels = [](const Scene& scene, const LevelsOfDetail& levels, const ViewCells& cells,
                           const O& options, JobRunner& runner, const Stages& stages) {
    return see_levels(scene, levels, cells, bounds_options(options, false), runner, stages);
  };
  producer.describe_levels = [](const O& options, const Screen& screen) {
    return describe_levels(bounds_options(options, false), screen);
  };
  return producer;
}

}  // namespace vismat
