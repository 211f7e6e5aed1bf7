#include "layout/best_order.h"

#include "layout/cost.h"
#include "layout/polished_tour.h"
#include "layout/scale_tour.h"

namespace vismat {
namespace {

// All pairs of 20,000 columns take seconds; of 400,000 they would take hours.
constexpr std::uint32_t most_paired = 20000;

}  // namespace

std::vector<std::uint32_t> best_visits(const SparsePoints& points, const BestOrderOptions& options) {
  if (points.size() <= most_paired) {
    return polished_visits(points,
                           {.polish = {.kicks_per_point = options.seconds > 0 ? 1e9 : 20.,
                                       .seed = options.seed,
                                       .seconds = options.seconds}},
                           options.threads);
  }
  const ColumnSketches sketches(points, 0, options.threads);
  const NeighbourLists lists = nearby_points(points, sketches, {.seed = options.seed}, options.threads);
  return visits_at_scale(points, sketches, lists, options.seed, options.threads);
}

Permutation best_order(const VisibilityMatrix& matrix, const BestOrderOptions& options) {
  const SparsePoints points(matrix);
  const std::vector<std::uint32_t> found = best_visits(points, options);
  if (runs_of_visits(points, found, options.threads) > count_runs(matrix))
    return Permutation::identity(matrix.shape().columns);
  return points.order_of_columns(found);
}

}  // namespace vismat
