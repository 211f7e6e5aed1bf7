// Tests medians, quantiles, how many passes are timed, and work in a process of its own.
#include "programs/measuring.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <stdexcept>
#include <vector>

namespace vismat {
namespace {

TEST(Measuring, MedianIsTheLargerOfTwoInTheMiddle) {
  EXPECT_EQ(median({}), 0);
  EXPECT_EQ(median({3}), 3);
  EXPECT_EQ(median({9, 1, 5}), 5);
  EXPECT_EQ(median({4, 1, 3, 2}), 3);
}

TEST(Measuring, QuantileIsTheLowerOfTwo) {
  EXPECT_EQ(quantile({}, .5), 0);
  EXPECT_EQ(quantile({4, 1, 3, 2}, .5), 2);
  EXPECT_EQ(quantile({4, 1, 3, 2}, 0), 1);
  EXPECT_EQ(quantile({4, 1, 3, 2}, 1), 4);
}

TEST(Measuring, PassesAreAsManyAsTold) {
  int done = 0;
  const Times times = time_passes({.seconds = 1e3, .least = 2, .most = 7}, [&] { ++done; });
  EXPECT_EQ(done, 7);
  EXPECT_EQ(times.passes, 7u);
  EXPECT_LE(times.least, times.median);
  EXPECT_LE(times.median, times.most);
}

TEST(Measuring, NoPassFollowsOneThatTookFarTooLong) {
  const Times times = time_passes({.seconds = 0}, [] {
    for (const double start = wall_seconds(); wall_seconds() - start < 1e-4;) {
    }
  });
  EXPECT_EQ(times.passes, 1u);
}

TEST(Measuring, WorkApartGivesItsValuesAndLeavesNothingBehind) {
  int here = 0;
  const auto values = apart<std::uint32_t>([&] {
    here = 1;
    return std::vector<std::uint32_t>(100'000, 7);
  });
  EXPECT_EQ(values, std::vector<std::uint32_t>(100'000, 7));
  EXPECT_EQ(here, 0);
  EXPECT_TRUE(apart<double>([] { return std::vector<double>{}; }).empty());
  EXPECT_THROW(apart<double>([]() -> std::vector<double> { throw std::runtime_error("told on stderr"); }),
               std::runtime_error);
}

}  // namespace
}  // namespace vismat
