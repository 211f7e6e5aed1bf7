// Tests tours in an array, whose parts are reversed, against a plain list.
#include "layout/tours/array_tour.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <set>

#include "layout/tours/tour.h"
#include "matrix/base/random.h"

namespace vismat {
namespace {

std::set<std::pair<std::uint32_t, std::uint32_t>> edges(const ArrayTour& tour) {
  std::set<std::pair<std::uint32_t, std::uint32_t>> all;
  for (const std::uint32_t p : tour.order()) all.insert(std::minmax({p, tour.next(p)}));
  return all;
}

TEST(ArrayTour, ExchangesTwoEdgesAndNothingElse) {
  Random random(4);
  for (const std::uint32_t size : {5u, 8u, 9u, 40u}) {
    Tour order(size);
    std::iota(order.begin(), order.end(), 0u);
    ArrayTour tour(order);
    for (int trial = 0; trial < 500; ++trial) {
      const bool forward = random.below(2) == 0;
      const auto follower = [&](std::uint32_t p) { return forward ? tour.next(p) : tour.prev(p); };
      const std::uint32_t a = random.below(size), b = follower(a), c = random.below(size), d = follower(c);
      if (c == a || c == b || d == a) continue;
      const Tour before = tour.order();
      auto expected = edges(tour);
      for (const auto& gone : {std::minmax({a, b}), std::minmax({c, d})}) expected.erase(gone);
      for (const auto& added : {std::minmax({a, c}), std::minmax({b, d})}) expected.insert(added);
      const ArrayTour::Way way = tour.exchange(a, b, c, d);
      EXPECT_EQ(edges(tour), expected);
      if (random.below(2) == 0) continue;
      tour.turn(way);
      EXPECT_EQ(tour.order(), before);
    }
  }
}

TEST(ArrayTour, CountsSteps) {
  const ArrayTour tour({3, 1, 4, 0, 2});
  EXPECT_EQ(tour.next(2), 3u);
  EXPECT_EQ(tour.prev(3), 2u);
  EXPECT_EQ(tour.steps(1, 2), 3u);
  EXPECT_EQ(tour.steps(2, 1), 2u);
  EXPECT_EQ(tour.apart(1, 2), 2u);
  EXPECT_EQ(tour.apart(1, 1), 0u);
}

}  // namespace
}  // namespace vismat
