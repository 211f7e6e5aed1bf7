// A proven lower bound on the number of runs that any order of the columns has, for matrices of any size.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "matrix/base/parallel.h"
#include "matrix/permutation.h"
#include "matrix/points/sparse_points.h"
#include "matrix/visibility_matrix.h"

namespace vismat {

struct LowerBound {
  std::uint64_t runs = 0;              // no order of the columns has fewer
  std::vector<std::uint64_t> history;  // the best bound after each step of an ascent; never falls
};

struct BoundOptions {
  /// If above 0, the ascent goes on for about that long, whatever the size, and the bound depends on the machine's
  /// speed.
  double seconds = 0;
  unsigned threads = 0;  // 0: one for each core; without `seconds` the bound does not depend on it
  Stages stages = {};
};

/// Up to 30,000 distinct columns this is Held and Karp's bound (held_karp.h), beyond that the two-nearest bound
/// (nearest_bound.h), unless `seconds` asks for more. `order` may be any order. The better it is, the faster the
/// search: near columns should be close to each other in it.
LowerBound lower_bound(const VisibilityMatrix& matrix, const Permutation& order,
                       const BoundOptions& options = {});
/// The bound for points that exist already; `visits` are all of them.
LowerBound lower_bound(const SparsePoints& points, std::span<const std::uint32_t> visits,
                       const BoundOptions& options = {});

}  // namespace vismat
