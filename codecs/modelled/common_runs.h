// Runs of columns that many rows of a file have where their references have nothing of the kind. The file lists them once;
// a row then names one of them in place of telling where it begins and how long it is.
#pragma once
#include <cstdint>
#include <vector>

namespace vismat {

class CommonRuns {
 public:
  struct Run {
    std::uint32_t start, end;  // the columns [start, end)
    std::uint32_t octave;      // it is as likely as 2^octave of the rarest ones
    auto operator<=>(const Run&) const = default;
  };
  static constexpr std::uint32_t most = 4096;  // runs in a file
  static constexpr std::uint32_t octaves = 6;
  static constexpr std::uint32_t none = 0xffffffff;

  CommonRuns() = default;
  /// `runs` in ascending order, all of them within [1, columns).
  CommonRuns(std::vector<Run> runs, std::uint32_t columns);
  const std::vector<Run>& runs() const { return runs_; }
  const Run& operator[](std::uint32_t index) const { return runs_[index]; }

  // Run i has the slots from first_slot(i) to first_slot(i + 1), 2^octave of them.
  struct Slots {
    std::uint32_t first = 0, count = 0;
  };
  /// Those of the runs that start in [from, to), to <= columns.
  Slots starting(std::uint32_t from, std::uint32_t to) const {
    if (runs_.empty()) return {};
    const std::uint32_t first = slots_before(from);
    return {first, slots_before(to) - first};
  }
  std::uint32_t of_slot(std::uint32_t slot) const { return of_slot_[slot]; }
  std::uint32_t first_slot(std::uint32_t index) const { return first_slot_[index]; }
  /// The run with these columns, or `none`. O(log runs).
  std::uint32_t find(std::uint32_t start, std::uint32_t end) const;

 private:
  std::uint32_t slots_before(std::uint32_t column) const {
    std::uint32_t i = bucket_[column >> shift_];
    while (start_[i] < column) ++i;
    return first_slot_[i];
  }
  std::vector<Run> runs_;
  std::vector<std::uint32_t> start_,
      first_slot_;  // of each run; behind the last, `none` and the number of slots
  std::vector<std::uint16_t> of_slot_;
  std::vector<std::uint16_t> bucket_;  // the first run that starts at or behind a multiple of 2^shift columns
  std::uint32_t shift_ = 0;
};

}  // namespace vismat
