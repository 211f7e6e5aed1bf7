// The producer "sampled": seen is what a ray reaches. Other rays, which take no part in the search, then estimate what it missed.
#include "visibility/rays/sampled.h"

#include "visibility/producers/bounds.h"
#include "visibility/producers/producers.h"

namespace vismat {
namespace {

/// As many rays as the sandwich casts.
SampledOptions sampled_options(const ProducerOptions& options) {
  return *bounds_options(options, true).sampled;
}

HeldBack sum(const std::vector<HeldBack>& cells) {
  HeldBack all;
  for (const HeldBack& cell : cells) {
    all.rays += cell.rays, all.missed_rays += cell.missed_rays;
    all.objects += cell.objects, all.missed_objects += cell.missed_objects;
  }
  return all;
}

}  // namespace

Producer sampled_producer() {
  using O = ProducerOptions;
  Producer producer;
  producer.name = "sampled";
  producer.idea = "rays, shared between the view cells that they cross";
  producer.guarantee = Guarantee::aggressive;
  producer.options = {&O::effort, &O::rays, &O::seed};
  producer.describe = [](const O& options) { return describe(sampled_options(options)); };
  producer.see = [](const Scene& scene, const ViewCells& cells, const O& options, JobRunner& runner,
                    const Stages& stages) {
    constexpr std::uint32_t rays_a_cell = 1000;
    const RayCaster caster(scene);
    const AimedRays rays(scene, caster);
    const SampledOptions sampled = sampled_options(options);
    Sight sight = see_by_sampling(rays, cells, sampled, runner, begin_stage(stages, "looking around"));
    sight.held_back = sum(held_back_error(rays, cells, sight.seen, rays_a_cell, sampled.seed, runner,
                                          begin_stage(stages, "checking by other rays")));
    return sight;
  };
  return producer;
}

}  // namespace vismat
