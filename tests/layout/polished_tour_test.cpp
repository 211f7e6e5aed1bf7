// Tests polished tours against brute force on up to 8 columns, and against the tours that they improve.
#include "layout/tours/polished_tour.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "layout/bounds/bound.h"
#include "layout/cost.h"
#include "layout/orders/random_order.h"
#include "layout/tours/exact_tour.h"
#include "tests/codecs/matrices.h"
#include "tests/sanitized.h"

namespace vismat {
namespace {

std::uint64_t fewest_runs(const VisibilityMatrix& m) {
  std::vector<std::uint32_t> order(m.shape().columns);
  std::iota(order.begin(), order.end(), 0u);
  std::uint64_t best = count_runs(m);
  do {
    best = std::min(best, count_runs(m, Permutation::from_old_of_new(order)));
  } while (std::next_permutation(order.begin(), order.end()));
  return best;
}

Tour best_tour(const ColumnPoints& points, std::uint64_t seed = 1) {
  const auto lists = exact_neighbours(points, 8);
  return polish(points, lists, greedy_edge_tour(points, lists), {.seed = seed});
}

TEST(PolishedTour, BoundAndPolishEmbraceTheOptimum) {
  Random random(1);
  for (int trial = 0; trial < (test::sanitized ? 20 : 60); ++trial) {
    const Shape shape{1 + random.below(12), 1 + random.below(7)};
    const auto m = test::random_matrix(shape, .1 + .8 * random.unit(), random.next());
    const ColumnPoints points(m);
    const std::uint64_t optimum = fewest_runs(m);
    EXPECT_LE(lower_bound(m, Permutation::identity(shape.columns)).runs, optimum);
    EXPECT_LE(optimum, count_runs(m, order_of_tour(best_tour(points))));
  }
}

TEST(PolishedTour, FindsAPlantedOrder) {  // column c sees rows c and c + 1: nothing but the planted order
                                          // has 41 runs
  const auto m = test::banded_matrix(40, 2, 7);
  const ColumnPoints points(m);
  EXPECT_EQ(count_runs(m, order_of_tour(best_tour(points))), 41u);
}

TEST(Polish, NeverLengthensAndKeepsEveryPoint) {
  for (const auto& m : test::assorted_matrices(true)) {
    const ColumnPoints points(m.matrix);
    const Tour before = nearest_neighbour_tour(points),
               after = polish(points, exact_neighbours(points, 5), before);
    EXPECT_LE(tour_length(points, after), tour_length(points, before)) << m.name;
    EXPECT_TRUE(std::is_permutation(before.begin(), before.end(), after.begin(), after.end())) << m.name;
  }
}

TEST(Polish, SameSeedSameTour) {
  const auto m = test::clustered_matrix({150, 110}, 5);
  const ColumnPoints points(m);
  const Tour tour = best_tour(points, 3);
  EXPECT_EQ(best_tour(points, 3), tour);
  EXPECT_NE(best_tour(points, 4), tour);
}

TEST(Polish, KicksShortenALocalOptimum) {
  const auto m = test::clustered_matrix({200, 150}, 5);
  const ColumnPoints points(m);
  const auto lists = exact_neighbours(points, 8);
  const Tour start = greedy_edge_tour(points, lists),
             optimum = polish(points, lists, start, {.kicks_per_point = 0});
  EXPECT_LT(tour_length(points, optimum), tour_length(points, start));
  EXPECT_EQ(tour_length(points, polish(points, lists, optimum, {.kicks_per_point = 0})),
            tour_length(points, optimum));
  EXPECT_LT(tour_length(points, polish(points, lists, optimum)), tour_length(points, optimum));
}

TEST(PolishedTour, EqualColumnsCostNothing) {  // each three times, far apart
  const auto m = test::clustered_matrix({150, 60}, 7);
  std::vector<std::vector<std::uint32_t>> rows;
  for (std::uint32_t r = 0; r < m.shape().rows; ++r) {
    rows.emplace_back();
    for (std::uint32_t copy = 0; copy < 3; ++copy) {
      for (const std::uint32_t c : m.row(r)) rows.back().push_back(copy * 60 + c);
    }
  }
  const auto tripled = VisibilityMatrix::from_rows(rows, 180);
  EXPECT_EQ(count_runs(tripled, order_by_polished_tour(tripled)), count_runs(m, order_by_polished_tour(m)));
}

}  // namespace
}  // namespace vismat
