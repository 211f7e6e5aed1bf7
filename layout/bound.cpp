#include "layout/bound.h"

#include "layout/cost.h"
#include "layout/distinct_columns.h"
#include "layout/held_karp.h"

namespace vismat {

LowerBound lower_bound(const VisibilityMatrix& matrix, const Permutation& order,
                       const BoundOptions& options) {
  const Permutation rows = Permutation::identity(matrix.shape().rows);
  const std::uint64_t known = count_runs(permute(matrix, rows, order));
  HeldKarpBound bound = held_karp_bound(ColumnPoints(distinct_columns(matrix).matrix),
                                        {.known_runs = known, .threads = options.threads});
  return {bound.runs, std::move(bound.history)};
}

}  // namespace vismat
