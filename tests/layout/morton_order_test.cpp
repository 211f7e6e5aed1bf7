// Tests a Z-order curve on four boxes.
#include "layout/orders/morton_order.h"

#include <gtest/gtest.h>

#include <vector>

namespace vismat {
namespace {

TEST(Morton, FollowsTheCurve) {
  std::vector<Box> boxes;
  for (const auto& [x, y] : {std::pair{3.f, 3.f}, {0.f, 0.f}, {3.f, 0.f}, {0.f, 3.f}})
    boxes.push_back({{x, y, 0}, {x, y, 0}});
  EXPECT_EQ(morton_order(boxes).old_of_new(), (std::vector<std::uint32_t>{1, 2, 3, 0}));
  EXPECT_EQ(morton_order(std::vector<Box>{}).size(), 0u);
}

}  // namespace
}  // namespace vismat
