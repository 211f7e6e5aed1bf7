// Tests exact neighbour lists against a full sort.
#include "matrix/points/column_points.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/codecs/matrices.h"

namespace vismat {
namespace {

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
