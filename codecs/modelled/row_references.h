// The encoder's choices: in which order rows stand, under which other row each is coded, and where groups begin.
#pragma once
#include <cstdint>
#include <vector>

#include "codecs/modelled/modelled_rows.h"
#include "codecs/modelled/row_bits.h"
#include "matrix/permutation.h"

namespace vismat {

/// A row's reference: another row, or none, the empty one.
inline constexpr std::uint32_t no_row = 0xffffffff;

struct RowPlan {
  std::vector<std::uint32_t> order;        // which row stands at each place; all that follows is by places
  std::uint32_t kept = 0;                  // the first rows, which readers keep
  std::vector<std::uint32_t> group_sizes;  // of the others
  std::vector<std::uint32_t> reference;    // an earlier place, or no_row
  std::vector<bool> raw;                   // stored as bitmaps
};
/// References among earlier rows, as the limits allow. The same for any number of threads.
RowPlan plan_rows(const VisibilityMatrix& matrix, const RowEnds& ends, const RowLimits& limits,
                  unsigned threads);

/// The order in which rows take the fewest bytes, for the order of columns that the matrix has: a tree in which each row
/// stands under the one that it is coded by, depth first, the rows that readers keep first.
Permutation order_for_references(const VisibilityMatrix& matrix, const RowLimits& limits, unsigned threads);

}  // namespace vismat
