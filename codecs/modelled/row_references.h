// The encoder's choices: in which order rows stand, under which other row each is coded, and where groups begin.
#pragma once
#include <cstdint>
#include <vector>

#include "codecs/modelled/modelled_rows.h"
#include "codecs/modelled/row_bits.h"

namespace vismat {

/// A row's reference: another row, or none, the empty one.
inline constexpr std::uint32_t no_row = 0xffffffff;

/// What a run end of a row costs that its reference lacks, against 1 for one too many: the distance by which references are
/// chosen (distance_with()).
inline constexpr std::uint32_t lacked_end = 4;

/// A near row, and how many run ends one of the two has and the other has not.
struct NearRow {
  std::uint32_t row, differ;
};
/// For each row some others, the most promising references first.
using NearRows = std::vector<std::vector<NearRow>>;

struct RowPlan {
  std::vector<std::uint32_t> order;        // which row stands at each place; all that follows is by places
  std::uint32_t kept = 0;                  // the first rows, which readers keep
  std::vector<std::uint32_t> group_sizes;  // of the others
  std::vector<std::uint32_t> reference;    // an earlier place, or no_row
  std::vector<bool> raw;                   // stored as bitmaps
};
/// References among earlier rows, as the limits allow. Where rows may move, their order is that of a tree in which each
/// row stands under the one that it is coded by, depth first, the rows that readers keep first. The same for any number
/// of threads.
RowPlan plan_rows(const RowEnds& ends, const RowLimits& limits, const EncodeOptions& options);

}  // namespace vismat
