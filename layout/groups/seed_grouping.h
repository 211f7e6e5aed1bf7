// Paper 002's choice of view cells to merge.
#pragma once
#include "layout/groups/grouping.h"

namespace vismat {

/// `seeds` groups are drawn for each merge [Zach & Karner 2003, 4.1]. Same seed, same groups. Quadratic in the distinct rows;
/// memory: rows * columns / 8 bytes. One thread.
Partition group_rows_by_seeds(const VisibilityMatrix& matrix, const GroupingOptions& options,
                              std::uint32_t seeds = 32);

}  // namespace vismat
