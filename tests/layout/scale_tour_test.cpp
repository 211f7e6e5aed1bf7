// Tests the order for many columns against tours over all pairs, at small size.
#include "layout/tours/scale_tour.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "layout/cost.h"
#include "layout/tours/polished_tour.h"
#include "layout/tours/sparse_search.h"
#include "matrix/generate.h"
#include "tests/codecs/matrices.h"

namespace vismat {
namespace {

TEST(ScaleTour, IsABijectionOfAnyMatrix) {
  for (const auto& m : test::assorted_matrices()) {
    EXPECT_EQ(order_by_scale_tour(m.matrix).size(), m.matrix.shape().columns) << m.name;
  }
}

TEST(ScaleTour, ComesNearAllPairsTours) {
  const auto m = generate_delta_scene(power_plant_scene(1. / 256));
  const ColumnPoints points(m);
  const auto lists = exact_neighbours(points, 10);
  const auto exact = polish(points, lists, greedy_edge_tour(points, lists), {.kicks_per_point = 0});
  EXPECT_LE(count_runs(m, order_by_scale_tour(m)) * 100, count_runs(m, order_of_tour(exact)) * 105);
}

TEST(ScaleTour, FindsAPlantedOrder) {  // column c sees rows c .. c + 19: at best each row is one run
  const auto m = test::banded_matrix(4000, 20, 1001);
  EXPECT_LE(count_runs(m, order_by_scale_tour(m)) * 10, 4020u * 11);
}

TEST(ScaleTour, SameOrderForAnyThreadCount) {
  const auto m = generate_delta_scene(power_plant_scene(1. / 256));
  const auto order = order_by_scale_tour(m, {}, 1);
  EXPECT_EQ(order, order_by_scale_tour(m, {}, 2));
  EXPECT_EQ(order, order_by_scale_tour(m, {}, 5));
}

TEST(GreedyTour, JoinsManyFragmentsIntoOneTour) {  // columns without near ones: nearly all are ends
  const auto m = test::random_matrix({400, 5000}, .03, 9);
  const SparsePoints points(m);
  const ColumnSketches sketches(points);
  const NeighbourLists none{0, {}, {}};
  auto tour = greedy_tour(points, sketches, none);
  std::sort(tour.begin(), tour.end());
  std::vector<std::uint32_t> all(points.size() + 1);
  std::iota(all.begin(), all.end(), 0u);
  EXPECT_EQ(tour, all);
}

TEST(ImproveTour, ShortensAShuffledTourAndKeepsItsPoints) {
  const auto m = test::clustered_matrix({400, 120}, 8);
  const SparsePoints points(m);
  const ColumnSketches sketches(points);
  const auto lists = nearby_points(points, sketches, {.neighbours = 8});
  std::vector<std::uint32_t> tour(points.size() + 1);
  std::iota(tour.begin(), tour.end(), 0u);
  Random random(3);
  for (std::uint32_t i = points.size(); i > 0; --i) std::swap(tour[i], tour[random.below(i + 1)]);
  const auto length = [&](const std::vector<std::uint32_t>& t) {
    std::uint64_t sum = points.distance(t.back(), t.front());
    for (std::size_t i = 1; i < t.size(); ++i) sum += points.distance(t[i - 1], t[i]);
    return sum;
  };
  const auto flipped = improve_tour(points, sketches, lists, tour, {.three_opt = false});
  const auto moved = improve_tour(points, sketches, lists, flipped);
  const auto held = improve_tour(points, sketches, lists, tour, {.longest_flip = 0});
  for (const auto& better : {flipped, moved, held})
    EXPECT_TRUE(std::is_permutation(tour.begin(), tour.end(), better.begin(), better.end()));
  EXPECT_LT(length(flipped) * 10, length(tour) * 8);
  EXPECT_LT(length(moved), length(flipped));
  EXPECT_EQ(held, tour);
}

TEST(KickTour, ShortensALocalOptimumAlikeForAnyThreadCount) {
  DeltaSceneOptions scene = power_plant_scene(1. / 64);
  scene.shape.columns = 5400;  // two windows
  const auto m = generate_delta_scene(scene);
  const SparsePoints points(m);
  ASSERT_GT(points.size(), 5000u);
  const ColumnSketches sketches(points);
  const auto lists = nearby_points(points, sketches);
  const auto optimum = improve_tour(points, sketches, lists, greedy_tour(points, sketches, lists));
  const auto kicked = kick_tour(points, sketches, lists, optimum, {.kicks_per_point = .3}, 1);
  EXPECT_LT(runs_of_visits(points, visits_of_tour(kicked)), runs_of_visits(points, visits_of_tour(optimum)));
  EXPECT_TRUE(std::is_permutation(optimum.begin(), optimum.end(), kicked.begin(), kicked.end()));
  EXPECT_EQ(kick_tour(points, sketches, lists, optimum, {.kicks_per_point = .3}, 3), kicked);
}

}  // namespace
}  // namespace vismat
