// The choice of rows to merge that loses least for its groups.
#pragma once
#include "layout/grouping.h"

namespace vismat {

/// Always the pair of the least score, of all pairs. Quadratic in the distinct rows; memory: rows * columns / 8 bytes. Same
/// groups for any number of threads; the seed is not used.
Partition group_rows_by_pairs(const VisibilityMatrix& matrix, const GroupingOptions& options);

/// The same, then rows move to better groups, and what that regains is spent on more pairs, until nothing is regained.
/// Memory besides: 4 bytes for each group and column.
Partition group_rows_by_exchange(const VisibilityMatrix& matrix, const GroupingOptions& options);

}  // namespace vismat
