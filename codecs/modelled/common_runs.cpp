#include "codecs/modelled/common_runs.h"

#include <algorithm>

namespace vismat {

CommonRuns::CommonRuns(std::vector<Run> runs, std::uint32_t columns) : runs_(std::move(runs)) {
  if (runs_.empty()) return;
  const auto count = static_cast<std::uint32_t>(runs_.size());
  for (std::uint32_t i = 0; i < count; ++i) {
    start_.push_back(runs_[i].start);
    first_slot_.push_back(static_cast<std::uint32_t>(of_slot_.size()));
    of_slot_.insert(of_slot_.end(), std::size_t{1} << runs_[i].octave, static_cast<std::uint16_t>(i));
  }
  start_.push_back(none);
  first_slot_.push_back(static_cast<std::uint32_t>(of_slot_.size()));
  while (columns >> shift_ > 4 * count) ++shift_;
  std::uint32_t i = 0;
  for (std::uint64_t bucket = 0; bucket <= columns >> shift_; ++bucket) {
    while (start_[i] < bucket << shift_) ++i;
    bucket_.push_back(static_cast<std::uint16_t>(i));
  }
}

std::uint32_t CommonRuns::find(std::uint32_t start, std::uint32_t end) const {
  const auto at = std::ranges::lower_bound(runs_, Run{start, end, 0});
  return at != runs_.end() && at->start == start && at->end == end
             ? static_cast<std::uint32_t>(at - runs_.begin())
             : none;
}

}  // namespace vismat
