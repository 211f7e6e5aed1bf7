// A choice of rows to merge: always the best of all pairs of groups.
#pragma once
#include "layout/groups/grouping.h"

namespace vismat {

/// Merges the pair with the least score of all pairs, again and again. Then rows move to better groups, and the
/// occlusions that this regains are spent on more merges, for several rounds or until nothing is regained. Quadratic in
/// the number of distinct rows; memory: rows * columns / 8 bytes and 4 for each group and column. The groups are the
/// same with any number of threads; the seed is not used.
Partition group_rows_by_pairs(const VisibilityMatrix& matrix, const GroupingOptions& options,
                              std::uint32_t rounds = 8);

}  // namespace vismat
