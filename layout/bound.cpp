#include "layout/bound.h"

#include "layout/held_karp.h"
#include "layout/nearest_bound.h"
#include "layout/sparse_points.h"

namespace vismat {

LowerBound lower_bound(const VisibilityMatrix& matrix, const Permutation& order,
                       const BoundOptions& options) {
  // All pairs of more take minutes: 24,400 points of the power plant a quarter of one.
  constexpr std::uint32_t most_points = 30000;
  const SparsePoints points(matrix);
  const std::vector<std::uint32_t> visits = points.visits_of_order(order);
  if (points.size() > most_points && options.seconds == 0) {
    const std::uint64_t runs = two_nearest_bound(points, visits, options.threads);
    return {runs, {runs}};
  }
  return held_karp_bound(points, visits, {.seconds = options.seconds, .threads = options.threads});
}

}  // namespace vismat
