// The table of producers: methods that compute what each view cell of a scene sees. The program and the tests loop over
// it.
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

class LevelsOfDetail;
struct Screen;

/// The options of all producers; producer_options() says what each means. An empty option means the producer's default.
struct ProducerOptions {
  std::optional<std::uint32_t> effort, points, patches, resolution, patch_resolution;
  std::optional<std::uint64_t> rays, patch_rays;
  std::optional<std::uint32_t> directions, viewpoints, passes;
  std::optional<double> enough;
  std::optional<std::uint64_t> seed;
  /// For what a producer prepares by itself; 0: one for each core. No result depends on it.
  unsigned threads = 0;
};
using ProducerSetting =
    std::variant<std::optional<std::uint32_t> ProducerOptions::*,
                 std::optional<std::uint64_t> ProducerOptions::*, std::optional<double> ProducerOptions::*>;

/// An option as a command line has it: its name without the dashes; its help; and its default, "" if that depends on
/// the effort.
struct ProducerOption {
  std::string_view name, help, by_default;
  ProducerSetting setting;
};
std::span<const ProducerOption> producer_options();

/// A method that computes what each view cell of a scene sees.
struct Producer {
  std::string_view name;
  std::string_view idea;  // one line
  /// What it guarantees. conservative: Sight::not_hidden lists all that is visible; aggressive: all that Sight::seen
  /// lists is visible.
  Guarantee guarantee = Guarantee::unknown;
  /// Whether a conservative producer also fills Sight::seen, with what is proven visible.
  bool seen_too = false;
  std::vector<ProducerSetting> options;  // those that it takes; never ProducerOptions::threads
  /// One line that names whatever the result depends on besides scene and cells. It goes into the file, and a journal
  /// belongs to it alone. Throws std::invalid_argument for options out of range.
  std::string (*describe)(const ProducerOptions& options) = nullptr;
  /// Computes what the cells see. The same scene, cells and options give the same result with any JobRunner, on one
  /// kind of CPU. All long work goes through the runner, so that it is shared between processes and continued after a
  /// kill. Is called on each process alike. Throws std::invalid_argument for options out of range and for view cells of
  /// a kind that it cannot handle.
  Sight (*see)(const Scene& scene, const ViewCells& cells, const ProducerOptions& options, JobRunner& runner,
               const Stages& stages) = nullptr;

  /// The same over the scene at the levels of detail that each cell allows, as see_levels() does it, and its line for
  /// levels that are made for this screen. Null if the producer cannot.
  LevelSight (*see_levels)(const Scene& scene, const LevelsOfDetail& levels, const ViewCells& cells,
                           const ProducerOptions& options, JobRunner& runner, const Stages& stages) = nullptr;
  std::string (*describe_levels)(const ProducerOptions& options, const Screen& screen) = nullptr;

  bool takes(const ProducerSetting& setting) const {
    return std::ranges::find(options, setting) != options.end();
  }
  const VisibilityMatrix& listed(const Sight& sight) const {
    return guarantee == Guarantee::aggressive ? sight.seen : sight.not_hidden;
  }
};

/// All producers, in the order in which tables list them.
std::span<const Producer> producers();
/// The producer of that name. Throws std::invalid_argument if there is none.
const Producer& producer_named(std::string_view name);
/// The names of the producers that take the option, with commas between them.
std::string takers_of(const ProducerOption& option);
/// Throws std::invalid_argument if options are given that the producer does not take.
void check_taken(const Producer& producer, const ProducerOptions& options);

/// Each of these has a file of its own.
Producer shadow_producer();
Producer sampled_producer();
Producer sandwich_producer();
Producer climbing_producer();

}  // namespace vismat
