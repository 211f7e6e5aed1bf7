// Tests that the random order makes every order equally likely.
#include "layout/orders/random_order.h"

#include <gtest/gtest.h>

#include <map>

namespace vismat {
namespace {

TEST(Random, TakesEveryOrderAlikeAndTheSeedAlone) {
  std::map<std::vector<std::uint32_t>, int> times;
  for (std::uint64_t seed = 0; seed < 6000; ++seed) ++times[random_order(3, seed).old_of_new()];
  ASSERT_EQ(times.size(), 6u);
  for (const auto& [order, count] : times) EXPECT_NEAR(count, 1000, 150);
  EXPECT_EQ(random_order(50, 7), random_order(50, 7));
}

}  // namespace
}  // namespace vismat
