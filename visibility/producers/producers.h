// The table of producers: each tells what every view cell of a scene sees. The program and the tests loop over it.
#pragma once
#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "matrix/dataset.h"
#include "visibility/jobs/job_runner.h"
#include "visibility/scene.h"
#include "visibility/sight.h"
#include "visibility/view_cells.h"

namespace vismat {

/// What all producers can be told; producer_options() says what each means. Nothing: the producer's default.
struct ProducerOptions {
  std::optional<std::uint32_t> effort, points, patches, resolution, patch_resolution;
  std::optional<std::uint64_t> rays, patch_rays;
  std::optional<std::uint32_t> directions, viewpoints, passes;
  std::optional<double> enough;
  std::optional<std::uint64_t> seed;
  unsigned threads = 0;  // of what a producer prepares by itself; 0: one a core. No result depends on it
};
using ProducerSetting =
    std::variant<std::optional<std::uint32_t> ProducerOptions::*,
                 std::optional<std::uint64_t> ProducerOptions::*, std::optional<double> ProducerOptions::*>;

/// How one of them is called on a command line, without the dashes; what it means; and its default, "" where that depends on
/// the effort.
struct ProducerOption {
  std::string_view name, help, by_default;
  ProducerSetting setting;
};
std::span<const ProducerOption> producer_options();

/// A plain value.
struct Producer {
  std::string_view name;
  std::string_view idea;  // one line
  /// Of what it lists. conservative: Sight::not_hidden lists all that is visible; aggressive: all that Sight::seen lists is
  /// visible.
  Guarantee guarantee = Guarantee::unknown;
  /// Of a conservative one: Sight::seen lists what is visible for sure.
  bool seen_too = false;
  std::vector<ProducerSetting> options;  // what it takes; never ProducerOptions::threads
  /// One line that names whatever the result depends on beside scene and cells; it goes into the file, and a journal is for it
  /// alone. Throws std::invalid_argument for options out of range.
  std::string (*describe)(const ProducerOptions& options) = nullptr;
  /// Same scene, cells and options, same result, whatever the JobRunner, on one kind of CPU: all long work goes through the
  /// runner, so that it is shared between processes and goes on after a kill. Called on each process alike. Throws
  /// std::invalid_argument for options out of range and for view cells of a kind that it cannot serve.
  Sight (*see)(const Scene& scene, const ViewCells& cells, const ProducerOptions& options, JobRunner& runner,
               const Stages& stages) = nullptr;

  bool takes(const ProducerSetting& setting) const {
    return std::ranges::find(options, setting) != options.end();
  }
  const VisibilityMatrix& listed(const Sight& sight) const {
    return guarantee == Guarantee::aggressive ? sight.seen : sight.not_hidden;
  }
};

/// All of them, in the order of tables.
std::span<const Producer> producers();
/// Throws std::invalid_argument where there is none of that name.
const Producer& producer_named(std::string_view name);
/// The names of those that take an option, with commas between.
std::string takers_of(const ProducerOption& option);
/// Throws std::invalid_argument where options are given that the producer does not take.
void check_taken(const Producer& producer, const ProducerOptions& options);

/// A file each.
Producer shadow_producer();
Producer sampled_producer();
Producer sandwich_producer();
Producer climbing_producer();

}  // namespace vismat
