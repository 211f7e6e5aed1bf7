// The default order of columns.
#pragma once
#include <cstdint>
#include <vector>

#include "matrix/base/parallel.h"
#include "matrix/permutation.h"
#include "matrix/points/sparse_points.h"
#include "matrix/visibility_matrix.h"

namespace vismat {

struct BestOrderOptions {
  std::uint64_t seed = 1;
  /// If above 0, tours are polished for that long, and the order depends on the machine's speed.
  double seconds = 0;
  unsigned threads = 0;
  Stages stages = {};
};

/// Up to 20,000 distinct columns this is the shorter of two polished tours. Beyond that, or if all their pairs would
/// take more than about half a minute, it is the scale tour. If the columns as they are have fewer runs, they stay.
/// Without `seconds` the same seed gives the same order with any number of threads. Fails on matrices without
/// structure, where no order is much better than another: leave the columns as they are.
Permutation best_order(const VisibilityMatrix& matrix, const BestOrderOptions& options = {});
/// The same tour, of points that exist already. It visits all of them, even if the columns as they are have fewer runs.
std::vector<std::uint32_t> best_visits(const SparsePoints& points, const BestOrderOptions& options = {});

}  // namespace vismat
