// The choice of rows to merge: always the pair that loses least.
#pragma once
#include "layout/grouping.h"

namespace vismat {

/// Same groups for any number of threads; the seed is not used. Quadratic in the distinct rows; memory: rows * columns / 8
/// bytes.
Partition group_rows_by_pairs(const VisibilityMatrix& matrix, const GroupingOptions& options);

}  // namespace vismat
