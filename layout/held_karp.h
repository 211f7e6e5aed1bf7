// A proven lower bound on the runs of any order of columns.
#pragma once
#include <cstdint>
#include <vector>

#include "layout/column_points.h"

namespace vismat {

struct HeldKarpOptions {
  std::uint32_t steps = 200;
  /// Runs of a known order, if any: sets the length of the steps, never the validity of the bound.
  std::uint64_t known_runs = 0;
  unsigned threads = 0;
};

struct HeldKarpBound {
  std::uint64_t runs = 0;              // no order of the columns has fewer
  std::vector<std::uint64_t> history;  // the best bound after each step: its convergence
};

/// Held & Karp's ascent [Operations Research 1970; Mathematical Programming 1971] over the closed tours
/// through the columns and the zero point. All in integers, so the bound is exact arithmetic. Keeps all
/// pairs: 2 bytes each up to 65535 rows, else 4; each step is one minimum spanning tree, O(columns^2).
HeldKarpBound held_karp_bound(const ColumnPoints& points, const HeldKarpOptions& options = {});

}  // namespace vismat
