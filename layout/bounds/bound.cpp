#include "layout/bounds/bound.h"

#include <algorithm>
#include <chrono>

#include "layout/bounds/held_karp.h"
#include "layout/bounds/nearest_bound.h"

namespace vismat {

LowerBound lower_bound(const VisibilityMatrix& matrix, const Permutation& order,
                       const BoundOptions& options) {
  const SparsePoints points(matrix);
  return lower_bound(points, points.visits_of_order(order), options);
}

LowerBound lower_bound(const SparsePoints& points, std::span<const std::uint32_t> visits,
                       const BoundOptions& options) {
  // All pairs of more take minutes: 24,400 points of the power plant a quarter of one.
  constexpr std::uint32_t most_points = 30000;
  if (points.size() <= most_points)
    return held_karp_bound(
        points, visits, {.seconds = options.seconds, .threads = options.threads, .stages = options.stages});
  const auto start = std::chrono::steady_clock::now();
  const std::uint64_t quick = two_nearest_bound(points, visits, {.stages = options.stages}, options.threads);
  LowerBound bound = {quick, {quick}};
  const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - start;
  if (spent.count() >= options.seconds) return bound;
  for (const std::uint64_t runs :
       held_karp_bound(
           points, visits,
           {.seconds = options.seconds - spent.count(), .threads = options.threads, .stages = options.stages})
           .history)
    bound.history.push_back(bound.runs = std::max(bound.runs, runs));
  return bound;
}

}  // namespace vismat
