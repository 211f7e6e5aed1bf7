// ALGORITHM. The default order. If all pairs can be computed, two tours are polished, each on its own core: one from
// greedy edges and one from the columns as they are. The shorter is taken. The second is never worse than the columns
// as they are. What a search with kicks starts from hardly matters: on five levels and artificial 1, with two seeds
// each, the two differ by 0.01 to 0.6 % in either direction, and so do two seeds from one start.
#include "layout/best_order.h"

#include <array>
#include <limits>
#include <numeric>
#include <utility>

#include "layout/cost.h"
#include "layout/tours/polished_tour.h"
#include "layout/tours/scale_tour.h"
#include "matrix/base/parallel.h"
#include "matrix/points/distinct_columns.h"
#include "matrix/points/near.h"

namespace vismat {
namespace {

// All pairs of 20,000 columns of 40,000 rows take about 30 seconds; of 400,000 they would take hours.
bool can_be_paired(const SparsePoints& points) {
  const double columns = points.size(), words = points.rows() / 64.;
  return columns <= 20000 && columns * columns * words <= 2.5e11;
}

std::vector<std::uint32_t> shorter_of_two(const SparsePoints& points, const BestOrderOptions& options) {
  const ColumnPoints columns(matrix_of(points));
  constexpr double without_limit = std::numeric_limits<double>::infinity();  // can_be_paired() is one
  const NeighbourLists lists = near_points(points,
                                           {.neighbours = PolishedTourOptions{}.neighbours,
                                            .zero = true,
                                            .exact_seconds = without_limit,
                                            .stages = options.stages},
                                           options.threads)
                                   .lists;
  PolishOptions polishing = PolishedTourOptions{}.polish;
  polishing.seed = options.seed;
  polishing.seconds = options.seconds;
  Tour as_they_stand(points.size() + 1);
  std::iota(as_they_stand.begin(), as_they_stand.end(), 0u);
  std::array<Tour, 2> tours = {greedy_edge_tour(columns, lists), std::move(as_they_stand)};
  const Progress kicks = begin_stage(options.stages, "kicks of the tours");
  parallel_for(tours.size(), options.threads, [&](std::uint64_t t) {
    PolishOptions own = polishing;
    if (t == 0) own.progress = kicks;
    tours[t] = polish(columns, lists, std::move(tours[t]), own);
  });
  const bool second = tour_length(columns, tours[1]) < tour_length(columns, tours[0]);
  return visits_of_tour(std::move(tours[second]));
}

}  // namespace

std::vector<std::uint32_t> best_visits(const SparsePoints& points, const BestOrderOptions& options) {
  if (can_be_paired(points)) return shorter_of_two(points, options);
  return visits_at_scale(
      points, {.nearby = {.seed = options.seed, .stages = options.stages}, .seconds = options.seconds},
      options.threads);
}

Permutation best_order(const VisibilityMatrix& matrix, const BestOrderOptions& options) {
  const SparsePoints points(matrix);
  const std::vector<std::uint32_t> found = best_visits(points, options);
  if (runs_of_visits(points, found, options.threads) > count_runs(matrix))
    return Permutation::identity(matrix.shape().columns);
  return points.order_of_columns(found);
}

}  // namespace vismat
