// A choice of rows to merge: the method of Zach and Karner 2003, which draws groups at random.
#pragma once
#include "layout/groups/grouping.h"

namespace vismat {

/// `seeds` groups are drawn for each merge [Zach & Karner 2003, section 4.1]. The same seed gives the same groups.
/// Quadratic in the number of distinct rows; memory: rows * columns / 8 bytes. One thread.
Partition group_rows_by_seeds(const VisibilityMatrix& matrix, const GroupingOptions& options,
                              std::uint32_t seeds = 32);

}  // namespace vismat
