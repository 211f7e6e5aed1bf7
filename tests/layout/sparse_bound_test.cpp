// Certificates against all pairs, bounds against the best of all orders.
#include "layout/sparse_bound.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <set>
#include <stdexcept>

#include "layout/cost.h"
#include "layout/sparse_tour.h"
#include "matrix/generate.h"
#include "tests/codecs/matrices.h"

namespace vismat {
namespace {

std::vector<std::uint32_t> in_order(const SparsePoints& points) {
  std::vector<std::uint32_t> visits(points.size());
  std::iota(visits.begin(), visits.end(), 0u);
  return visits;
}

std::uint64_t fewest_runs(const SparsePoints& points) {
  auto visits = in_order(points);
  std::uint64_t best = runs_of_visits(points, visits, 1);
  while (std::next_permutation(visits.begin(), visits.end()))
    best = std::min(best, runs_of_visits(points, visits, 1));
  return best;
}

void expect_true(const SparsePoints& points, const CertifiedNeighbours& certified) {
  const std::uint32_t k = certified.lists.per_point;
  std::vector<std::set<std::uint32_t>> listed(points.size());
  for (std::uint32_t p = 0; p < points.size(); ++p) {
    for (std::uint32_t i = 0; i < k; ++i) {
      const std::uint32_t q = certified.lists.ids[p * k + i];
      if (q == 0xffffffff) continue;
      EXPECT_EQ(certified.lists.distances[p * k + i], points.distance(p, q));
      EXPECT_TRUE(listed[p].insert(q).second && q != p);
    }
  }
  for (std::uint32_t p = 0; p < points.size(); ++p) {
    for (std::uint32_t q = 0; q < points.size(); ++q) {
      if (q == p || listed[p].contains(q) || listed[q].contains(p)) continue;
      EXPECT_GE(points.distance(p, q), std::max(certified.threshold[p], certified.threshold[q]));
    }
  }
}

TEST(Certify, ThresholdsHoldForAllPairsWhateverTheWork) {
  for (const auto& m : test::assorted_matrices()) {
    const SparsePoints points(m.matrix);
    const ColumnSketches sketches(points);
    const auto lists = nearby_points(points, sketches, {.neighbours = 4, .window = 1, .rounds = 0});
    for (const std::uint64_t work : {0u, 20u, 100000u}) {
      expect_true(points,
                  certify_neighbours(points, sketches, lists, in_order(points), {.block = 5, .work = work}));
    }
  }
}

TEST(Certify, WithEnoughWorkListsAreTheNearest) {
  const auto m = generate_delta_scene(power_plant_scene(1. / 512));
  const SparsePoints points(m);
  const ColumnSketches sketches(points);
  const auto lists = nearby_points(points, sketches, {.neighbours = 6, .tables = 1, .rounds = 0});
  const auto certified = certify_neighbours(points, sketches, lists, in_order(points), {}, 1);
  EXPECT_NE(certified.lists.distances, lists.distances);  // there was something to find
  for (std::uint32_t p = 0; p < points.size(); ++p) {
    std::vector<std::uint32_t> all;
    for (std::uint32_t q = 0; q < points.size(); ++q) {
      if (q != p) all.push_back(points.distance(p, q));
    }
    std::sort(all.begin(), all.end());
    const auto begin = certified.lists.distances.begin() + p * 6;
    EXPECT_TRUE(std::equal(begin, begin + 6, all.begin()));
    EXPECT_EQ(certified.threshold[p], all[5]);
  }
  const auto threaded = certify_neighbours(points, sketches, lists, in_order(points), {}, 3);
  EXPECT_EQ(threaded.lists.ids, certified.lists.ids);
  EXPECT_EQ(threaded.threshold, certified.threshold);
}

TEST(Certify, RefusesBlocksOfNothing) {
  const SparsePoints points(VisibilityMatrix(Shape{2, 2}));
  EXPECT_THROW(certify_neighbours(points, ColumnSketches(points), {}, {}, {.block = 0}),
               std::invalid_argument);
}

TEST(SparseBound, NeverExceedsTheOptimum) {
  Random random(1);
  for (int trial = 0; trial < 100; ++trial) {
    const Shape shape{1 + random.below(14), 1 + random.below(7)};
    const SparsePoints points(test::random_matrix(shape, .1 + .8 * random.unit(), random.next()));
    const ColumnSketches sketches(points);
    const std::uint64_t optimum = fewest_runs(points);
    const std::uint32_t listed = 1 + random.below(3);
    const auto lists = nearby_points(points, sketches, {.neighbours = listed, .window = 1, .rounds = 0});
    for (const std::uint64_t work : {0u, 1000u}) {
      const auto certified =
          certify_neighbours(points, sketches, lists, in_order(points), {.block = 2, .work = work});
      EXPECT_LE(two_nearest_bound(points, certified), optimum);
      for (const std::uint64_t told : {std::uint64_t{0}, std::uint64_t{1}, optimum, optimum * 10}) {
        const auto bound = sparse_held_karp_bound(points, certified, {.known_runs = told});
        EXPECT_LE(bound.runs, optimum);
        EXPECT_TRUE(std::is_sorted(bound.history.begin(), bound.history.end()));
      }
    }
  }
}

TEST(SparseBound, IsTightOnAPlantedOrder) {  // column c sees rows c and c + 1
  std::vector<std::vector<std::uint32_t>> rows(41);
  for (std::uint32_t c = 0; c < 40; ++c) {
    for (const std::uint32_t r : {c, c + 1}) rows[r].push_back(c * 7 % 40);
  }
  for (auto& row : rows) std::sort(row.begin(), row.end());
  const SparsePoints points(VisibilityMatrix::from_rows(rows, 40));
  const ColumnSketches sketches(points);
  const auto certified =
      certify_neighbours(points, sketches, nearby_points(points, sketches), in_order(points));
  EXPECT_EQ(two_nearest_bound(points, certified), 41u);
  EXPECT_GE(sparse_held_karp_bound(points, certified, {.known_runs = 41}).runs, 40u);
}

TEST(SparseBound, IsNearATourOfAScene) {
  const auto m = generate_delta_scene(power_plant_scene(1. / 256));
  const SparsePoints points(m);
  const ColumnSketches sketches(points);
  const auto lists = nearby_points(points, sketches, {.neighbours = 16});
  const auto visits = visits_at_scale(points, sketches, lists);
  const auto runs = runs_of_visits(points, visits);
  const auto certified = certify_neighbours(points, sketches, lists, visits);
  const auto two = two_nearest_bound(points, certified),
             held_karp = sparse_held_karp_bound(points, certified, {.known_runs = runs}).runs;
  EXPECT_LE(held_karp, runs);
  EXPECT_GT(two * 135, runs * 100);
  EXPECT_GT(held_karp * 120, runs * 100);
}

}  // namespace
}  // namespace vismat
