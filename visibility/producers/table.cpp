// The table of producers, and of the options that they take.
#include "visibility/producers/producers.h"

#include <stdexcept>

namespace vismat {

std::span<const Producer> producers() {
  static const std::vector<Producer> table = {
      shadow_producer(),
      sampled_producer(),
      sandwich_producer(),
      climbing_producer(),
  };
  return table;
}

const Producer& producer_named(std::string_view name) {
  const auto found = std::ranges::find(producers(), name, &Producer::name);
  if (found == producers().end()) {
    throw std::invalid_argument("there is no producer '" + std::string(name) + "'");
  }
  return *found;
}

std::span<const ProducerOption> producer_options() {
  using O = ProducerOptions;
  static const std::vector<ProducerOption> table = {
      {"effort",
       "0: shadows of the whole view cell; 1: also of some patches of its surface; 2: of many patches", "1",
       &O::effort},
      {"points", "Number of projection points of a view cell: 1, 9 or 27", "", &O::points},
      {"patches", "Greatest number of patches of a view cell's surface to look from", "", &O::patches},
      {"resolution", "Pixels along a side of each of a view's six faces", "", &O::resolution},
      {"patch-resolution", "The same for patches", "", &O::patch_resolution},
      {"rays", "Greatest number of aimed rays for each view cell and round", "", &O::rays},
      {"patch-rays", "Number of rays for each patch", "", &O::patch_rays},
      {"directions", "Number of unaimed directions around each viewpoint in the first pass", "128",
       &O::directions},
      {"viewpoints", "Number of viewpoints on each edge of a view cell in each pass", "12", &O::viewpoints},
      {"passes", "Greatest number of passes", "4", &O::passes},
      {"enough", "A view cell is done when a pass adds less than this share of what it sees", "0.01",
       &O::enough},
      {"seed", "Another seed casts other rays", "1", &O::seed},
  };
  return table;
}

std::string takers_of(const ProducerOption& option) {
  std::string names;
  for (const Producer& producer : producers()) {
    if (producer.takes(option.setting)) names += (names.empty() ? "" : ", ") + std::string(producer.name);
  }
  return names;
}

void check_taken(const Producer& producer, const ProducerOptions& options) {
  for (const ProducerOption& option : producer_options()) {
    const bool given = std::visit([&](auto member) { return (options.*member).has_value(); }, option.setting);
    if (given && !producer.takes(option.setting)) {
      throw std::invalid_argument("--" + std::string(option.name) + ": the producer " +
                                  std::string(producer.name) +
                                  " does not take it; these do: " + takers_of(option));
    }
  }
}

}  // namespace vismat
