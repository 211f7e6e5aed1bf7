// The presets. A data sheet gives the rate of small reads, one at a time, and that of large reads, of the whole drive. From these
// come the two figures of the model: the channels' speeds add up to the rate of large reads, and one read of 4096 bytes on an idle
// disk takes as long as the rate of small reads says. The number of channels is our choice: with more, many small reads come nearer
// to what drives do with long queues, and a single large read becomes slower than it is.
#include "runtime/storage/virtual_disk.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>

#include "matrix/base/number_list.h"
#include "matrix/base/random.h"

namespace vismat {
namespace {

constexpr Nanoseconds millisecond = 1'000'000, microsecond = 1'000;
constexpr unsigned most_channels = 256;

constexpr std::array presets{
    DiskModel{"disk-2004", 9 * millisecond, 0, 40e6, 1,
              "Western Digital, WD Caviar WD400BB, specifications "
              "(www.lyberty.com/tech/hard_drives/WD_Caviar_WD400BB_specs): "
              "average read seek 8.9 ms typical, rounded to 9; buffer to disk 244 to 400 Mbit/s, whose "
              "middle is 40.25 MB/s, "
              "rounded to 40. The average rotational latency of 4.2 ms and the controller's 0.3 ms are not "
              "in the 9 ms; with "
              "them it is 13.5,40,1,4.2."},
    DiskModel{"sata-ssd", 70 * microsecond, 0, 135e6, 4,
              "Samsung 850 EVO 1 TB, data sheet as quoted by its sellers (www.wired2fire.co.uk): 4 KB random "
              "reads one at a "
              "time at most 10,000/s, sequential reads at most 540 MB/s. 100 us less 4096 bytes at 135 MB/s "
              "are 69.7, rounded "
              "to 70; four channels are our choice."},
    DiskModel{
        "nvme", 57 * microsecond, 0, 425e6, 8,
        "Samsung 970 EVO 1 TB, specifications as tabled by Techgage (techgage.com/news/"
        "samsung-reveals-the-970-pro-970-evo-generation-m-2-ssds): 4K random reads one at a time 15,000/s, "
        "sequential "
        "reads 3,400 MB/s. 66.7 us less 4096 bytes at 425 MB/s are 57.0; eight channels are our choice."},
    DiskModel{
        "network", 20 * millisecond, 10 * millisecond, 3.125e6, 4,
        "Latency: Ookla's report of a second quarter in the United States, as told by POTs and PANs "
        "(potsandpansbyccg.com/tag/ookla): 9 ms for the landline provider with the lowest, 31 ms for the "
        "mobile one with "
        "the lowest, rounded to 10 and 30. Speed: the 100 Mbit/s that the FCC proposed as the benchmark for "
        "broadband in "
        "2023, through four connections, which are our choice. That latency is uniform is an assumption."},
};

void check(const DiskModel& model) {
  const bool good = model.channels >= 1 && model.channels <= most_channels && model.bytes_per_second >= 1 &&
                    model.bytes_per_second <= 1e12 && model.jitter >= 0 && model.jitter <= model.latency &&
                    model.latency <= 60'000 * millisecond;
  if (!good)
    throw std::invalid_argument(
        "a disk has 1 to 256 channels of at least 1 byte/s and at most 1000000 MB/s each, a latency of at "
        "most 60000 ms, and a "
        "jitter of at most the latency");
}

}  // namespace

std::span<const DiskModel> disk_models() {
  return presets;
}

const DiskModel& disk_model(std::string_view name) {
  const auto found = std::ranges::find(presets, name, &DiskModel::name);
  if (found != presets.end()) return *found;
  std::string names;
  for (const DiskModel& model : presets) names += (names.empty() ? "" : ", ") + std::string(model.name);
  throw std::invalid_argument("no disk is called '" + std::string(name) + "'; there are " + names);
}

DiskModel parse_disk_model(std::string_view text) {
  if (text.find(',') == std::string_view::npos) {
    try {
      return disk_model(text);
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument(
          error.what() + std::string(", or LATENCY_MS,MB_PER_S,CHANNELS[,JITTER_MS] such as 0.1,135,4"));
    }
  }
  const std::vector<double> numbers = number_list(text);
  const bool complete = numbers.size() == 3 || numbers.size() == 4;
  if (!complete || numbers[2] != std::floor(numbers[2]) || numbers[2] < 1 || numbers[2] > most_channels) {
    throw std::invalid_argument(
        "'" + std::string(text) +
        "' is no disk: LATENCY_MS,MB_PER_S,CHANNELS[,JITTER_MS], with a whole number of channels from 1 "
        "to 256, such as 0.1,135,4");
  }
  DiskModel model;
  model.name = "custom";
  model.source = "as given";
  model.latency = std::llround(numbers[0] * millisecond);
  model.bytes_per_second = numbers[1] * 1e6;
  model.channels = static_cast<unsigned>(numbers[2]);
  if (numbers.size() == 4) model.jitter = std::llround(numbers[3] * millisecond);
  check(model);
  return model;
}

VirtualDisk::VirtualDisk(const DiskModel& model, std::uint64_t seed)
    : latency_(model.latency), jitter_(model.jitter), bytes_per_second_(model.bytes_per_second), seed_(seed) {
  check(model);
  free_.resize(model.channels, 0);
}

Nanoseconds VirtualDisk::free_at() const {
  return *std::ranges::min_element(free_);
}

Nanoseconds VirtualDisk::begin(Nanoseconds now, std::uint64_t bytes) {
  const auto channel = std::ranges::min_element(free_);
  const double u = 2 * Random(seed_, reads_++).fraction() - 1;
  const Nanoseconds jitter = std::llround(static_cast<double>(jitter_) * u);
  const Nanoseconds transfer = std::llround(static_cast<double>(bytes) * 1e9 / bytes_per_second_);
  return *channel = std::max(now, *channel) + latency_ + jitter + transfer;
}

}  // namespace vismat
