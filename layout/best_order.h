// The order of columns to take by default.
#pragma once
#include <cstdint>
#include <vector>

#include "layout/points/sparse_points.h"
#include "matrix/base/parallel.h"
#include "matrix/permutation.h"
#include "matrix/visibility_matrix.h"

namespace vismat {

struct BestOrderOptions {
  std::uint64_t seed = 1;
  /// If above 0, tours are polished that long; the order then depends on the machine's speed.
  double seconds = 0;
  unsigned threads = 0;
  Stages stages = {};
};

/// Up to 20,000 distinct columns the shorter of two polished tours, beyond them, or where their pairs would take more than
/// about half a minute, the scale tour; the columns as they stand where these have fewer runs. Same seed and no `seconds`,
/// same order, for any thread count. Breaks on matrices without structure, where no order is much better than another:
/// take the columns as they stand.
Permutation best_order(const VisibilityMatrix& matrix, const BestOrderOptions& options = {});
/// The same tour, of points that are there already: all of them, whether or not these are better than the columns as they stand.
std::vector<std::uint32_t> best_visits(const SparsePoints& points, const BestOrderOptions& options = {});

}  // namespace vismat
