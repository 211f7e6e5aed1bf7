// Near points and what finds them, against distances counted plainly.
#include "matrix/points/near.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "matrix/base/random.h"
#include "matrix/generate.h"
#include "matrix/points/inverted_index.h"
#include "matrix/points/point_comparison.h"
#include "tests/codecs/matrices.h"

namespace vismat {
namespace {

using Lists = std::vector<std::vector<std::pair<std::uint32_t, std::uint32_t>>>;  // (distance, point)

// All other points, nearest first; a one that the other one lacks counts `lacked`.
Lists brute_force(const SparsePoints& points, std::uint32_t lacked = 1) {
  Lists lists(points.size());
  for (std::uint32_t p = 0; p < points.size(); ++p) {
    const auto of = points.ones(p);
    for (std::uint32_t q = 0; q < points.size(); ++q) {
      if (q == p) continue;
      const auto other = points.ones(q);
      auto lacks = static_cast<std::uint32_t>(of.size());
      for (std::size_t i = 0, j = 0; i < of.size() && j < other.size();) {
        lacks -= of[i] == other[j];
        of[i] <= other[j] ? ++i : ++j;
      }
      const auto beyond = static_cast<std::uint32_t>(other.size() + lacks - of.size());
      lists[p].emplace_back(lacked * lacks + beyond, q);
    }
    std::ranges::sort(lists[p]);
  }
  return lists;
}

Lists first_few(const Lists& lists, std::size_t most) {
  Lists first;
  for (const auto& list : lists)
    first.emplace_back(list.begin(), list.begin() + static_cast<std::ptrdiff_t>(std::min(list.size(), most)));
  return first;
}

Lists plain(const NeighbourLists& lists, std::uint32_t points) {
  Lists result(points);
  for (std::uint32_t p = 0; p < points; ++p) {
    for (std::uint32_t n = 0; n < lists.per_point; ++n)
      result[p].emplace_back(lists.distances[p * lists.per_point + n], lists.ids[p * lists.per_point + n]);
  }
  return result;
}

std::vector<std::pair<std::string, VisibilityMatrix>> adversarial() {
  std::vector<std::vector<std::uint32_t>> apart(60), in_pairs(60), one(60, std::vector<std::uint32_t>{7});
  for (std::uint32_t r = 0; r < 60; ++r) {
    apart[r] = {r};  // all distances are equal
    in_pairs[r] = {r / 2 * 2, 60};
  }
  return {{"empty", VisibilityMatrix({60, 60})},
          {"all equal", VisibilityMatrix::from_rows(one, 60)},
          {"one column", VisibilityMatrix::from_rows(std::vector(60, std::vector<std::uint32_t>{0}), 1)},
          {"all as far", VisibilityMatrix::from_rows(apart, 60)},
          {"in pairs", VisibilityMatrix::from_rows(in_pairs, 61)}};
}

TEST(NearPoints, AreThoseOfBruteForce) {
  auto matrices = adversarial();
  for (const auto& m : test::assorted_matrices()) matrices.emplace_back(m.name, m.matrix);
  matrices.emplace_back("plant", generate_delta_scene(power_plant_scene(1. / 2048)));
  for (const auto& [name, matrix] : matrices) {
    for (const bool collapse : {true, false}) {
      const SparsePoints points(matrix, collapse);
      for (const std::uint32_t lacked : {1u, 4u}) {
        const Lists real = brute_force(points, lacked);
        for (const std::uint32_t wanted : {1u, 5u, 1000u}) {
          const NearPoints near = near_points(points, {.neighbours = wanted, .lacked = lacked}, 2);
          EXPECT_TRUE(near.exact);
          EXPECT_EQ(plain(near.lists, points.size()), first_few(real, wanted)) << name;
        }
        // What is found with sketches is as far as it says.
        const NearPoints near =
            near_points(points, {.neighbours = 5, .lacked = lacked, .exact_seconds = 0}, 2);
        const Lists found = plain(near.lists, points.size());
        for (std::uint32_t p = 0; p < points.size(); ++p) {
          for (const auto& [distance, q] : found[p]) {
            if (q == no_point) continue;
            EXPECT_TRUE(std::ranges::binary_search(real[p], std::pair(distance, q))) << name;
          }
        }
      }
    }
  }
}

TEST(NearPoints, HaveTheZeroPointAmongThem) {
  for (const auto& [name, matrix] : adversarial()) {
    const SparsePoints points(matrix, false);
    for (const std::uint32_t wanted : {1u, 7u, 1000u}) {
      const NeighbourLists lists = near_points(points, {.neighbours = wanted, .zero = true}).lists,
                           real = exact_neighbours(ColumnPoints(matrix), wanted);
      EXPECT_EQ(lists.per_point, real.per_point) << name;
      EXPECT_EQ(lists.ids, real.ids) << name;
      EXPECT_EQ(lists.distances, real.distances) << name;
    }
  }
}

TEST(NearPoints, AreMostlyFoundWherePairsAreTooMany) {
  const SparsePoints points(generate_delta_scene(power_plant_scene(1. / 512)));
  const NearPoints near = near_points(points, {.exact_seconds = 0});
  EXPECT_FALSE(near.exact);
  const Lists found = plain(near.lists, points.size()), real = brute_force(points);
  std::size_t hits = 0;
  for (std::uint32_t p = 0; p < points.size(); ++p) {
    ASSERT_EQ(found[p].size(), 10u);
    EXPECT_TRUE(std::ranges::is_sorted(found[p]));
    for (const auto& [distance, q] : found[p]) {
      ASSERT_LT(q, points.size());
      EXPECT_EQ(distance, points.distance(p, q));
      hits += distance <= real[p][9].first;
    }
  }
  EXPECT_GE(hits, std::size_t{8} * points.size());
}

TEST(NearPoints, SayWhatTheyCannotFind) {
  for (const auto& [name, matrix] : adversarial()) {
    const SparsePoints points(matrix, false);
    const NearPoints near = near_points(points, {.neighbours = 3, .exact_seconds = -1});
    EXPECT_EQ(near.exact, points.size() < 2) << name;
    for (std::uint32_t p = 0; p < points.size(); ++p) {
      for (std::uint32_t n = 0; n < near.lists.per_point; ++n) {
        const std::uint32_t q = near.lists.ids[p * near.lists.per_point + n],
                            distance = near.lists.distances[p * near.lists.per_point + n];
        EXPECT_EQ(distance, q == no_point ? no_point : points.distance(p, q)) << name;
        EXPECT_NE(q, p) << name;
      }
    }
  }
}

TEST(NearPoints, SameListsForAnyThreadCount) {
  const SparsePoints points(generate_delta_scene(power_plant_scene(1. / 512)));
  for (const double seconds : {0., 120.}) {
    const auto near = [&](unsigned threads) {
      return near_points(points, {.exact_seconds = seconds}, threads).lists;
    };
    const NeighbourLists one = near(1);
    for (const unsigned threads : {2u, 3u, 7u}) {
      EXPECT_EQ(near(threads).ids, one.ids);
      EXPECT_EQ(near(threads).distances, one.distances);
    }
  }
}

TEST(PointComparison, HasAllDistancesByBitsAndByIndex) {
  for (const double density : {.01, .6}) {  // the index is cheaper for the one, bits for the other
    const SparsePoints points(test::random_matrix({300, 70}, density, 3));
    EXPECT_EQ(all_pairs_cost(points).by_index < all_pairs_cost(points).by_bits, density < .1);
    const PointComparison comparison(points);
    std::vector<std::uint32_t> distances;
    for (std::uint32_t p = 0; p < points.size(); ++p) {
      comparison.distances_of(p, distances);
      ASSERT_EQ(distances.size(), points.size());
      for (std::uint32_t q = 0; q < points.size(); ++q) ASSERT_EQ(distances[q], points.distance(p, q));
    }
  }
}

// Weights that 16 bits cannot count.
TEST(PointComparison, CountsLongColumns) {
  std::vector<std::vector<std::uint32_t>> rows(70000, {0, 1});
  rows[5] = {0};
  rows[9] = {1, 2};
  const SparsePoints points(VisibilityMatrix::from_rows(rows, 40), false);
  std::vector<std::uint32_t> distances;
  PointComparison(points).distances_of(0, distances);
  EXPECT_EQ(distances[1], 2u);
  EXPECT_EQ(distances[2], 70000u);
  EXPECT_EQ(distances[3], 69999u);
}

TEST(InvertedIndex, FollowsWhatSetsGainAndLose) {
  Random random(5);
  constexpr std::uint32_t sets = 30, ids = 20;
  const VisibilityMatrix matrix = test::random_matrix({sets, ids}, .4, 6);
  std::vector<std::vector<bool>> has(sets, std::vector<bool>(ids, false));
  for (std::uint32_t s = 0; s < sets; ++s) {
    for (const std::uint32_t id : matrix.row(s)) has[s][id] = true;
  }
  InvertedIndex index(sets, ids, [&](std::uint32_t s) { return matrix.row(s); });
  for (int change = 0; change < 500; ++change) {
    const std::uint32_t id = random.below(ids), from = random.below(sets), to = random.below(sets);
    if (!has[from][id] || has[to][id]) continue;
    if (change % 2 == 0) {
      index.erase(id, from);
      index.insert(id, to);
    } else {
      index.give(id, from, to);
    }
    has[from][id] = false;
    has[to][id] = true;
  }
  for (std::uint32_t id = 0; id < ids; ++id) {
    std::vector<std::uint32_t> expected;
    for (std::uint32_t s = 0; s < sets; ++s) {
      if (has[s][id]) expected.push_back(s);
    }
    EXPECT_TRUE(std::ranges::equal(index.sets_with(id), expected));
  }
  std::vector<std::uint32_t> common(sets, 0);
  const std::vector<std::uint32_t> asked = {1, 4, 5, 19};
  index.count_common(asked, common.data());
  for (std::uint32_t s = 0; s < sets; ++s)
    EXPECT_EQ(common[s], std::ranges::count_if(asked, [&](std::uint32_t id) { return has[s][id]; }));
  // Every third set is taken out.
  std::vector<std::uint32_t> new_of_old(sets);
  for (std::uint32_t s = 0; s < sets; ++s) new_of_old[s] = s % 3 == 0 ? InvertedIndex::no_set : 2 * s;
  index.renumber(new_of_old);
  for (std::uint32_t id = 0; id < ids; ++id) {
    std::vector<std::uint32_t> expected;
    for (std::uint32_t s = 0; s < sets; ++s) {
      if (has[s][id] && s % 3 != 0) expected.push_back(2 * s);
    }
    EXPECT_TRUE(std::ranges::equal(index.sets_with(id), expected));
  }
}

}  // namespace
}  // namespace vismat
