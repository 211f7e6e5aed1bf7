// Tours and bounds against brute force on matrices of up to 8 columns, and against one another on larger
// ones.
#include "layout/exact_tour.h"
#include "layout/polished_tour.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "layout/bound.h"
#include "layout/cost.h"
#include "layout/random_order.h"
#include "tests/codecs/matrices.h"

namespace vismat {
namespace {

std::uint64_t runs_in_order(const VisibilityMatrix& m, const Permutation& order) {
  return count_runs(permute(m, Permutation::identity(m.shape().rows), order));
}

std::uint64_t fewest_runs(const VisibilityMatrix& m) {
  std::vector<std::uint32_t> order(m.shape().columns);
  std::iota(order.begin(), order.end(), 0u);
  std::uint64_t best = count_runs(m);
  do {
    best = std::min(best, runs_in_order(m, Permutation::from_old_of_new(order)));
  } while (std::next_permutation(order.begin(), order.end()));
  return best;
}

Tour best_tour(const ColumnPoints& points, std::uint64_t seed = 1) {
  const auto lists = exact_neighbours(points, 8);
  return polish(points, lists, greedy_edge_tour(points, lists), {.seed = seed});
}

TEST(Cost, CountsGroupsOfOnes) {
  EXPECT_EQ(count_runs(VisibilityMatrix::from_rows({{0, 1, 3}, {}, {2}, {0, 1, 2, 3}}, 4)), 4u);
  EXPECT_EQ(count_runs(VisibilityMatrix(Shape{3, 3})), 0u);
}

TEST(Cost, OfAnOrderIsThatOfTheReorderedMatrix) {
  for (const auto& m : test::assorted_matrices()) {
    const auto order = random_order(m.matrix.shape().columns, 5);
    EXPECT_EQ(count_runs(m.matrix, order), runs_in_order(m.matrix, order)) << m.name;
  }
}

TEST(Tour, IsTwiceAsLongAsItsOrderHasRuns) {
  for (const auto& m : test::assorted_matrices()) {
    const ColumnPoints points(m.matrix);
    const Tour tour = nearest_neighbour_tour(points);
    EXPECT_EQ(tour_length(points, tour), 2 * runs_in_order(m.matrix, order_of_tour(tour))) << m.name;
    EXPECT_EQ(order_of_tour(tour_of_order(order_of_tour(tour))), order_of_tour(tour)) << m.name;
  }
}

TEST(Tour, BoundAndPolishEmbraceTheOptimum) {
  Random random(1);
  for (int trial = 0; trial < 60; ++trial) {
    const Shape shape{1 + random.below(12), 1 + random.below(7)};
    const auto m = test::random_matrix(shape, .1 + .8 * random.unit(), random.next());
    const ColumnPoints points(m);
    const std::uint64_t optimum = fewest_runs(m);
    EXPECT_LE(lower_bound(m, Permutation::identity(shape.columns)).runs, optimum);
    EXPECT_LE(optimum, runs_in_order(m, order_of_tour(best_tour(points))));
  }
}

TEST(Tour, FindsAPlantedOrder) {  // column c sees rows c and c + 1: nothing but the planted order
                                           // has 41 runs
  std::vector<std::vector<std::uint32_t>> rows(41);
  for (std::uint32_t c = 0; c < 40; ++c) {
    for (const std::uint32_t r : {c, c + 1}) rows[r].push_back(c * 7 % 40);
  }
  for (auto& row : rows) std::sort(row.begin(), row.end());
  const auto m = VisibilityMatrix::from_rows(rows, 40);
  const ColumnPoints points(m);
  EXPECT_EQ(runs_in_order(m, order_of_tour(best_tour(points))), 41u);
}

TEST(Polish, NeverLengthensAndKeepsEveryPoint) {
  for (const auto& m : test::assorted_matrices()) {
    const ColumnPoints points(m.matrix);
    const Tour before = nearest_neighbour_tour(points),
               after = polish(points, exact_neighbours(points, 5), before);
    EXPECT_LE(tour_length(points, after), tour_length(points, before)) << m.name;
    EXPECT_TRUE(std::is_permutation(before.begin(), before.end(), after.begin(), after.end())) << m.name;
  }
}

TEST(Polish, SameSeedSameTour) {
  const auto m = test::clustered_matrix({200, 150}, 5);
  const ColumnPoints points(m);
  EXPECT_EQ(best_tour(points, 3), best_tour(points, 3));
  EXPECT_NE(best_tour(points, 3), best_tour(points, 4));
}

TEST(ExactNeighbours, AreThoseOfAFullSort) {
  const auto m = test::clustered_matrix({100, 60}, 6);
  const ColumnPoints points(m);
  const auto lists = exact_neighbours(points, 7, 1);
  EXPECT_EQ(exact_neighbours(points, 7, 2).ids, lists.ids);
  for (std::uint32_t p = 0; p <= points.size(); ++p) {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> all;
    for (std::uint32_t q = 0; q <= points.size(); ++q) {
      if (q != p) all.emplace_back(points.distance(p, q), q);
    }
    std::sort(all.begin(), all.end());
    for (std::uint32_t i = 0; i < 7; ++i) {
      EXPECT_EQ(lists.ids[p * 7 + i], all[i].second);
      EXPECT_EQ(lists.distances[p * 7 + i], all[i].first);
    }
  }
}

}  // namespace
}  // namespace vismat
