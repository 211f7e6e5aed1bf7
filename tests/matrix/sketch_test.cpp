// Sketches of points and near neighbours, against distances counted plainly.
#include "matrix/points/sketch.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>

#include "matrix/generate.h"
#include "tests/codecs/matrices.h"

namespace vismat {
namespace {

TEST(ColumnSketches, NeverExceedTheDistance) {
  const auto m = test::clustered_matrix({3000, 200}, 4);
  const SparsePoints points(m);
  std::vector<std::uint32_t> distances;
  for (std::uint32_t a = 0; a <= points.size(); ++a) {
    for (std::uint32_t b = 0; b < a; ++b) distances.push_back(points.distance(a, b));
  }
  for (const std::uint32_t bits : {0u, 64u, 4096u}) {
    const ColumnSketches sketches(points, bits, 2);
    std::uint64_t bound = 0, distance = 0;
    std::size_t pair = 0;
    for (std::uint32_t a = 0; a <= points.size(); ++a) {
      for (std::uint32_t b = 0; b < a; ++b) {
        const std::uint32_t least = sketches.lower_bound(a, b), real = distances[pair++];
        ASSERT_LE(least, real);
        bound += least;
        distance += real;
      }
    }
    if (bits == 4096) {
      EXPECT_GT(bound * 10, distance * 9);
    }
  }
  EXPECT_THROW(ColumnSketches(points, 1000), std::invalid_argument);
  EXPECT_THROW(ColumnSketches(points, 32), std::invalid_argument);
}

TEST(NearbyPoints, HaveExactDistancesAndHighRecall) {
  const auto m = generate_delta_scene(power_plant_scene(1. / 256));
  const SparsePoints points(m);
  const auto lists = nearby_points(points, ColumnSketches(points), {}, 2);
  ASSERT_EQ(lists.per_point, 10u);
  std::uint32_t found = 0;
  constexpr std::uint32_t asked = 200;
  for (std::uint32_t p = 0; p < asked; ++p) {
    std::uint32_t nearest = 0xffffffff;
    for (std::uint32_t q = 0; q < points.size(); ++q) {
      if (q != p) nearest = std::min(nearest, points.distance(p, q));
    }
    for (std::uint32_t i = 0; i < 10; ++i) {
      const std::uint32_t q = lists.ids[p * 10 + i];
      ASSERT_LT(q, points.size());
      EXPECT_NE(q, p);
      EXPECT_EQ(lists.distances[p * 10 + i], points.distance(p, q));
      EXPECT_TRUE(i == 0 || lists.distances[p * 10 + i - 1] <= lists.distances[p * 10 + i]);
    }
    found += lists.distances[p * 10] == nearest;
  }
  EXPECT_GE(found, asked * 9 / 10);
}

TEST(NearbyPoints, SameListsForAnyThreadCount) {
  const auto m = generate_delta_scene(power_plant_scene(1. / 256));
  const SparsePoints points(m);
  const ColumnSketches sketches(points);
  const auto lists = nearby_points(points, sketches, {}, 1);
  EXPECT_EQ(lists.ids, nearby_points(points, sketches, {}, 2).ids);
  EXPECT_EQ(lists.ids, nearby_points(points, ColumnSketches(points, 0, 3), {}, 3).ids);
  EXPECT_NE(lists.ids, nearby_points(points, sketches, {.rounds = 0, .seed = 2}, 1).ids);
}

TEST(NearbyPoints, FewPoints) {
  for (const std::uint32_t columns : {0u, 1u, 2u, 3u}) {
    const auto m = test::random_matrix({30, columns}, .5, columns);
    const SparsePoints points(m);
    const auto lists = nearby_points(points, ColumnSketches(points), {}, 1);
    EXPECT_EQ(lists.per_point, columns == 0 ? 0 : columns - 1);
  }
}

}  // namespace
}  // namespace vismat
