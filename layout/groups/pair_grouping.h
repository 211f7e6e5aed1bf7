// A choice of rows to merge: always the best of all pairs of groups.
#pragma once
#include "layout/groups/grouping.h"

namespace vismat {

struct PairGroupingOptions {
  std::uint32_t rounds = 8;  // of moves and more merges
  /// If all distances of sparse rows are estimated to take more processor time than this, near rows are found with
  /// sketches at first. The estimate depends on the matrix alone, never on the machine.
  double exact_seconds = 5;
  std::uint32_t few_groups = 4096;  // then all pairs are compared
};

/// Merges the pair with the least score of all pairs, again and again. Then rows move to better groups, and the
/// occlusions that this regains are spent on more merges, for several rounds or until nothing is regained. Where there
/// are too many sparse rows, the pair is the best of those of near rows and groups until few groups are left.
/// Quadratic in the number of distinct rows, then nearly linear; memory: rows * columns / 8 bytes and 4 for each group
/// and column, or, for sparse rows, some 24 bytes for each one and 300 for each row. The groups are the same with any
/// number of threads; the seed chooses sketches.
Partition group_rows_by_pairs(const VisibilityMatrix& matrix, const GroupingOptions& options,
                              const PairGroupingOptions& how = {});

}  // namespace vismat
