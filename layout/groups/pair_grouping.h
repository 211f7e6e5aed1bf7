// The choice of rows to merge that loses least for its groups.
#pragma once
#include "layout/groups/grouping.h"

namespace vismat {

/// Always the pair of the least score, of all pairs; then rows move to better groups, and what that regains is spent on more
/// pairs, for so many rounds or until nothing is regained: five rounds are enough on all matrices here. Quadratic in the
/// distinct rows; memory: rows * columns / 8 bytes and 4 for each group and column. Same groups for any number of threads;
/// the seed is not used.
Partition group_rows_by_pairs(const VisibilityMatrix& matrix, const GroupingOptions& options,
                              std::uint32_t rounds = 8);

}  // namespace vismat
