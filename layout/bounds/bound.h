// How few runs any order of the columns can have: a proven bound, at any size.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "layout/points/sparse_points.h"
#include "matrix/base/parallel.h"
#include "matrix/permutation.h"
#include "matrix/visibility_matrix.h"

namespace vismat {

struct LowerBound {
  std::uint64_t runs = 0;              // no order of the columns has fewer
  std::vector<std::uint64_t> history;  // the best bound after each step of an ascent, never falling
};

struct BoundOptions {
  /// If above 0, ascends for about that long, whatever the size; the bound then depends on the machine's speed.
  double seconds = 0;
  unsigned threads = 0;  // 0: one a core; without `seconds` the bound does not depend on it
  Stages stages = {};
};

/// Up to 30,000 distinct columns Held and Karp's bound (held_karp.h), beyond that the two-nearest bound
/// (nearest_bound.h) unless `seconds` asks for more. `order` is any known order, the better the faster: near
/// columns should stand near each other in it.
LowerBound lower_bound(const VisibilityMatrix& matrix, const Permutation& order,
                       const BoundOptions& options = {});
/// Of points that are there already; `visits` are all of them.
LowerBound lower_bound(const SparsePoints& points, std::span<const std::uint32_t> visits,
                       const BoundOptions& options = {});

}  // namespace vismat
