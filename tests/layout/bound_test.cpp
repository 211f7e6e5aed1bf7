// Tests certificates against all pairs of columns, and bounds against the best of all orders.
#include "layout/bounds/bound.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <limits>
#include <numeric>
#include <set>
#include <stdexcept>

#include "layout/bounds/held_karp.h"
#include "layout/bounds/nearest_bound.h"
#include "layout/orders/random_order.h"
#include "layout/tours/scale_tour.h"
#include "matrix/generate.h"
#include "matrix/points/pair_distances.h"
#include "tests/codecs/matrices.h"
#include "tests/sanitized.h"

namespace vismat {
namespace {

std::vector<std::uint32_t> in_order(const SparsePoints& points) {
  std::vector<std::uint32_t> visits(points.size());
  std::iota(visits.begin(), visits.end(), 0u);
  return visits;
}

// Over all orders: the shortest way from the zero point through a set of points to its last one, for each set
// and last one [Bellman 1962].
std::uint64_t fewest_runs(const SparsePoints& points) {
  const std::uint32_t n = points.size();
  if (n == 0) return 0;
  std::vector<std::vector<std::uint32_t>> distance(n, std::vector<std::uint32_t>(n));
  for (std::uint32_t a = 0; a < n; ++a) {
    for (std::uint32_t b = 0; b < n; ++b) distance[a][b] = points.distance(a, b);
  }
  std::vector<std::vector<std::uint64_t>> shortest(1u << n, std::vector<std::uint64_t>(n, 1u << 30));
  for (std::uint32_t p = 0; p < n; ++p) shortest[1u << p][p] = points.weight(p);
  for (std::uint32_t set = 1; set < 1u << n; ++set) {
    for (std::uint32_t last = 0; last < n; ++last) {
      for (std::uint32_t p = 0; p < n; ++p) {
        if (set >> p & 1) continue;
        std::uint64_t& way = shortest[set | 1u << p][p];
        way = std::min(way, shortest[set][last] + distance[last][p]);
      }
    }
  }
  std::uint64_t tour = 1u << 30;
  for (std::uint32_t p = 0; p < n; ++p) tour = std::min(tour, shortest.back()[p] + points.weight(p));
  return tour / 2;
}

TEST(LowerBound, IsJudgedByTheTrueOptimum) {
  Random random(7);
  for (int trial = 0; trial < 20; ++trial) {
    const SparsePoints points(
        test::random_matrix({1 + random.below(9), 1 + random.below(6)}, .4, random.next()));
    auto visits = in_order(points);
    std::uint64_t best = runs_of_visits(points, visits, 1);
    while (std::next_permutation(visits.begin(), visits.end()))
      best = std::min(best, runs_of_visits(points, visits, 1));
    EXPECT_EQ(fewest_runs(points), best);
  }
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

TEST(LowerBound, NeverExceedsTheOptimum) {
  Random random(1);
  for (int trial = 0; trial < (test::sanitized ? 25 : 60); ++trial) {
    const Shape shape{1 + random.below(14), 1 + random.below(9)};
    const auto m = test::random_matrix(shape, .1 + .8 * random.unit(), random.next());
    const SparsePoints points(m);
    const ColumnSketches sketches(points);
    const std::uint64_t optimum = fewest_runs(points);
    const std::uint32_t listed = 1 + random.below(3);
    const auto lists = nearby_points(points, sketches, {.neighbours = listed, .window = 1, .rounds = 0});
    for (const std::uint64_t work : {0u, 1000u}) {
      const auto certified =
          certify_neighbours(points, sketches, lists, in_order(points), {.block = 2, .work = work});
      EXPECT_LE(two_nearest_bound(points, certified), optimum);
    }
    EXPECT_LE(two_nearest_bound(points, in_order(points)), optimum);
    for (const std::uint32_t neighbours : {1u, 3u}) {
      for (const std::uint64_t pair_bytes : {std::uint64_t{0}, std::uint64_t{1000}}) {
        const auto bound =
            held_karp_bound(points, in_order(points), {.neighbours = neighbours, .pair_bytes = pair_bytes});
        EXPECT_LE(bound.runs, optimum);
        EXPECT_GE(bound.runs, two_nearest_bound(points, in_order(points)));
        EXPECT_TRUE(std::is_sorted(bound.history.begin(), bound.history.end()));
      }
    }
    EXPECT_LE(lower_bound(m, random_order(shape.columns, 1)).runs, optimum);
  }
}

// The priced ascent on few candidates against the plain one over all pairs: the first round's bound is the
// cheapest 1-tree under the two-nearest potentials, which Prim's algorithm makes from all pairs.
TEST(HeldKarp, PricedOneTreeIsThatOfAllPairs) {
  for (const auto& m : test::assorted_matrices()) {
    const SparsePoints points(m.matrix);
    const std::uint32_t n = points.size();
    if (n < 3) continue;
    std::vector<std::int64_t> potential;
    for (std::uint32_t p = 0; p < n; ++p) {
      std::vector<std::uint32_t> distances;
      for (std::uint32_t q = 0; q < n; ++q) {
        if (q != p) distances.push_back(points.distance(p, q));
      }
      std::sort(distances.begin(), distances.end());
      potential.push_back(-static_cast<std::int64_t>(distances[1]) * 128);
    }
    std::vector<std::int64_t> key(n, std::numeric_limits<std::int64_t>::max());
    std::vector<bool> inside(n, false);
    std::int64_t weight = 0;
    for (std::uint32_t last = 0, joined = 1; joined < n; ++joined) {
      inside[last] = true;
      std::uint32_t next = n;
      for (std::uint32_t p = 0; p < n; ++p) {
        if (inside[p]) continue;
        key[p] =
            std::min(key[p], 256 * std::int64_t{points.distance(last, p)} + potential[last] + potential[p]);
        if (next == n || key[p] < key[next]) next = p;
      }
      weight += key[next];
      last = next;
    }
    std::vector<std::int64_t> spokes;
    for (std::uint32_t p = 0; p < n; ++p)
      spokes.push_back(256 * std::int64_t{points.weight(p)} + potential[p]);
    std::sort(spokes.begin(), spokes.end());
    weight +=
        spokes[0] + spokes[1] - 2 * std::accumulate(potential.begin(), potential.end(), std::int64_t{0});
    const auto bound = held_karp_bound(points, in_order(points), {.rounds = 1, .steps = 1, .neighbours = 2});
    EXPECT_EQ(bound.runs, static_cast<std::uint64_t>(std::max<std::int64_t>(0, (weight + 511) / 512)))
        << m.name;
  }
}

TEST(PairDistances, AreThoseOfThePointsHoweverMade) {
  for (const auto& m : test::assorted_matrices()) {
    const SparsePoints points(m.matrix);
    for (const std::uint64_t most_bytes : {std::uint64_t{0}, std::uint64_t{1} << 30}) {
      const PairDistances pairs(points, most_bytes);
      std::atomic<std::uint32_t> rows = 0;
      pairs.each_row([&](std::uint32_t p, std::span<const Distance16> distances) {
        ++rows;
        for (std::uint32_t q = 0; q < points.size(); ++q)
          EXPECT_EQ(distances[q], points.distance(p, q)) << m.name;
      });
      EXPECT_EQ(rows, points.size());
    }
  }
}

TEST(HeldKarp, SameBoundForAnyThreadsAndWhetherPairsAreKept) {
  const auto m = generate_delta_scene(power_plant_scene(1. / 512));
  const SparsePoints points(m);
  const auto first = held_karp_bound(points, in_order(points), {.rounds = 3, .threads = 1});
  const auto threaded = held_karp_bound(points, in_order(points), {.rounds = 3, .threads = 3});
  const auto made_anew = held_karp_bound(points, in_order(points), {.rounds = 3, .pair_bytes = 0});
  EXPECT_EQ(threaded.history, first.history);
  EXPECT_EQ(made_anew.history, first.history);
}

TEST(HeldKarp, StopsInTimeWithWhatIsProven) {
  const auto m = generate_delta_scene(power_plant_scene(1. / 512));
  const SparsePoints points(m);
  EXPECT_TRUE(held_karp_bound(points, in_order(points), {.seconds = 1e-9, .pair_bytes = 0}).history.empty());
  EXPECT_EQ(held_karp_bound(points, in_order(points), {.seconds = 1e-9}).history.size(), 1u);
}

TEST(LowerBound, IsTightOnAPlantedOrder) {  // column c sees rows c and c + 1
  const auto m = test::banded_matrix(40, 2, 7);
  const SparsePoints points(m);
  EXPECT_EQ(two_nearest_bound(points, in_order(points)), 41u);
  EXPECT_EQ(lower_bound(m, Permutation::identity(40)).runs, 41u);
}

TEST(LowerBound, OfNothingAndOfOneColumn) {
  EXPECT_EQ(lower_bound(VisibilityMatrix(Shape{0, 0}), Permutation::identity(0)).runs, 0u);
  EXPECT_EQ(lower_bound(VisibilityMatrix(Shape{5, 3}), Permutation::identity(3)).runs, 0u);
  EXPECT_EQ(lower_bound(VisibilityMatrix::from_rows({{0}, {}, {0}}, 1), Permutation::identity(1)).runs, 2u);
  EXPECT_EQ(lower_bound(VisibilityMatrix::from_rows({{0, 1}, {0, 1}}, 2), Permutation::identity(2)).runs, 2u);
}

TEST(LowerBound, IsNearATourOfAScene) {
  const auto m = generate_delta_scene(power_plant_scene(1. / 256));
  const SparsePoints points(m);
  const auto visits = visits_at_scale(points);
  const auto runs = runs_of_visits(points, visits);
  const auto held_karp = held_karp_bound(points, visits);
  EXPECT_LE(held_karp.runs, runs);
  EXPECT_GT(two_nearest_bound(points, visits) * 135, runs * 100);
  EXPECT_GT(held_karp.runs * 106, runs * 100);
}

}  // namespace
}  // namespace vismat
