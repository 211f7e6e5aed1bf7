// How rows are grouped into parts and find their references: what of the format stands around the rows themselves.
#pragma once
#include <algorithm>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "codecs/modelled/modelled_rows.h"
#include "codecs/modelled/row_model.h"
#include "matrix/base/byte_reader.h"

namespace vismat {

// Rows that can be references are numbered: 0 is the empty row, 1 to K are the kept ones, and from K + 1 on come the others,
// as they stand in the file.

// A part of the payload: some rows that follow one another.
struct Group {
  std::uint32_t first = 0, size = 0;  // rows
  std::uint32_t outside = 0;          // the number of the row that its first row is coded under
  std::uint32_t above = none;         // the group that this one is in; `none` if it is kept or empty
  static constexpr std::uint32_t none = 0xffffffff;
};

// Codes the sizes and references of groups, one after another.
class GroupCode {
 public:
  GroupCode(std::uint32_t rows, std::uint32_t kept) : kept_(kept), next_(kept), left_(rows - kept) {}
  std::uint32_t left() const { return left_; }
  template <typename Coder>
  Group code(Coder& coder, std::span<const Group> before, Group group) {
    group.first = next_;
    group.size =
        code_number(coder, NumberKind::group, std::min(left_, ModelledRowFormat::largest_group), group.size);
    next_ += group.size;
    left_ -= group.size;
    if (before.empty() || coder.decide(group.above == Group::none, group_kept)) {
      const std::uint32_t count = kept_ + 1;
      const std::uint32_t step =
          code_number(coder, NumberKind::kept, count, (group.outside + count - last_kept_) % count + 1) - 1;
      group.above = Group::none;
      group.outside = last_kept_ = (last_kept_ + step) % count;
      return group;
    }
    group.above = code_above(coder, before, group.above);
    const Group& above = before[group.above];
    group.outside =
        above.first + code_number(coder, NumberKind::within, above.size, group.outside - above.first);
    return group;
  }

 private:
  // The last group, one of those that it takes, or else any earlier one.
  template <typename Coder>
  static std::uint32_t code_above(Coder& coder, std::span<const Group> before, std::uint32_t target) {
    const auto count = static_cast<std::uint32_t>(before.size());
    std::uint32_t above = count - 1;
    for (std::uint32_t step = 0; step < ModelledRowFormat::steps && above != Group::none;
         ++step, above = before[above].above) {
      if (!coder.decide(target != above, group_back + step)) return above;
    }
    return count - code_number(coder, NumberKind::distance, count, count - target);
  }
  std::uint32_t kept_, next_, left_, last_kept_ = 0;
};

// Codes the reference of row `place` of a group: an earlier row of the group, the last one first, or the reference of the
// group's first row, or any kept row.
template <typename Coder>
std::uint32_t code_reference(Coder& coder, const Group& group, std::uint32_t kept, std::uint32_t place,
                             std::uint32_t target) {
  for (std::uint32_t back = 0; back < place; ++back) {
    const std::uint32_t row = group.first + place - back;  // its number
    if (!coder.decide(target != row, reference_back + back)) return row;
  }
  if (!coder.decide(target != group.outside, reference_kept)) return group.outside;
  return coder.even(1 + kept, target);
}

/// Codes which row is a row's second reference: 0 for the one under which the first is coded; 1 to `way` for that many rows
/// back among those decoded on the way to this one; way + 1 + x for the row of number x <= kept.
template <typename Coder>
std::uint32_t code_second(Coder& coder, std::uint32_t context, std::uint32_t kept, std::uint32_t way,
                          std::uint32_t target) {
  if (!coder.decide(target != 0, second_other + context)) return 0;
  if (way == 0 || coder.decide(target > way, second_kept + context))
    return way + 1 + coder.even(kept + 1, target - way - 1);
  return code_number(coder, NumberKind::second, way, target);
}
enum class Stands : std::uint32_t { kept, first, in_group };
/// The context of code_second() for a row that stands there, under a reference of so many run ends.
inline std::uint32_t second_context(Stands stands, std::uint32_t ends) {
  return static_cast<std::uint32_t>(stands) * 8 +
         std::min(static_cast<std::uint32_t>(std::bit_width(ends)), 7u);
}
inline Stands stands_at(std::uint32_t place) {
  return place == 0 ? Stands::first : Stands::in_group;
}

/// Codes the runs that rows may name. A reader's ones are in order, within the columns, and no more than `CommonRuns::most`.
template <typename Coder>
CommonRuns code_common_runs(Coder& coder, std::uint32_t columns, const CommonRuns& written) {
  const std::uint32_t most = columns < 3 ? 0 : CommonRuns::most;
  const std::uint32_t count =
      code_number(coder, NumberKind::runs, most + 1, static_cast<std::uint32_t>(written.runs().size()) + 1) -
      1;
  std::vector<CommonRuns::Run> runs;
  CommonRuns::Run before{1, 1, 0};
  for (std::uint32_t i = 0; i < count; ++i) {
    CommonRuns::Run run = Coder::reads ? before : written[i];
    run.start =
        before.start +
        code_number(coder, NumberKind::run_gap, columns - 1 - before.start, run.start - before.start + 1) - 1;
    // Runs that start together come with the longer ones behind.
    const std::uint32_t least = run.start == before.start ? before.end : run.start;
    if (least >= columns - 1) throw FormatError("a common run that no row can have");
    run.end = least + code_number(coder, NumberKind::run_length, columns - 1 - least, run.end - least);
    run.octave = code_number(coder, NumberKind::run_octave, CommonRuns::octaves, run.octave + 1) - 1;
    runs.push_back(before = run);
  }
  return {std::move(runs), columns};
}

/// Codes a row as its bitmap, 16 columns at a time. Row and out as in code_row.
template <typename Coder, typename Out>
void code_raw(Coder& coder, std::uint32_t columns, RowCursor row, Out& out) {
  for (std::uint32_t at = 0; at < columns; at += 16) {
    const std::uint32_t count = std::min(columns - at, 16u);
    std::uint32_t bits = 0;
    if constexpr (!Coder::reads) {
      for (std::uint32_t i = 0; i < count; ++i) {
        row.pass(at + i);
        bits |= std::uint32_t{row.value} << i;
      }
    }
    bits = coder.even(1u << count, bits);
    out.room(20);
    for (std::uint32_t i = 0; i < count; ++i) out.to(at + i, bits >> i & 1);
  }
}

}  // namespace vismat
