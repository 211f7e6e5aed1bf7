#include "visibility/geometry/plane_geometry.h"

#include <gtest/gtest.h>

#include "matrix/base/random.h"
#include "visibility/geometry/point_bounds.h"

namespace vismat {
namespace {

using Points = std::vector<glm::dvec2>;

double turn(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
  return cross(b - a, c - b);
}

TEST(ConvexHull, BeginsAtTheLeastPointAndLeavesOutWhatIsStraight) {
  EXPECT_EQ(convex_hull(Points{{2, 2}, {1, 0}, {0, 2}, {0, 0}, {2, 0}, {1, 1}, {0, 0}}, turn),
            (Points{{0, 0}, {2, 0}, {2, 2}, {0, 2}}));
  EXPECT_LT(convex_hull(Points{{0, 0}, {1, 1}, {3, 3}}, turn).size(), 3u);
  EXPECT_TRUE(convex_hull(Points{}, turn).empty());
}

TEST(ConvexHull, HasEachPairOfCornersWithAllPointsOnItsLeft) {
  Random random(5);
  for (int round = 0; round < 300; ++round) {
    Points points;
    for (std::uint32_t n = 3 + random.below(20); n > 0; --n)
      points.emplace_back(random.below(9), random.below(9));  // whole numbers: exact, and often on one line
    const Points hull = convex_hull(points, turn);
    std::size_t sides =
        0;  // pairs of different points with none on the right, and none beyond them on the line
    for (const glm::dvec2& a : hull) {
      for (const glm::dvec2& b : hull) {
        sides += a != b && std::all_of(points.begin(), points.end(),
                                       [&](const glm::dvec2& p) { return cross(b - a, p - a) >= 0; });
      }
    }
    if (hull.size() < 3) continue;
    ASSERT_EQ(sides, hull.size());
    for (std::size_t i = 0; i < hull.size(); ++i) {
      const glm::dvec2 &a = hull[i], &b = hull[(i + 1) % hull.size()], &c = hull[(i + 2) % hull.size()];
      ASSERT_GT(turn(a, b, c), 0);
      for (const glm::dvec2& p : points) ASSERT_GE(cross(b - a, p - a), 0);
    }
  }
}

TEST(Bounds, HoldPointsAndMeet) {
  const Bounds bounds = bounds_of(std::vector<glm::dvec3>{{0, 5, -1}, {2, 1, -3}});
  EXPECT_EQ(bounds.low, glm::dvec3(0, 1, -3));
  EXPECT_EQ(bounds.high, glm::dvec3(2, 5, -1));
  EXPECT_TRUE(meet(bounds, bounds_of(Box{{2, 5, -1}, {3, 6, 0}})));
  EXPECT_FALSE(meet(bounds, bounds_of(Box{{2, 5, -0.5f}, {3, 6, 0}})));
  EXPECT_FALSE(meet(bounds, Bounds{}));
  EXPECT_EQ(largest_coordinate({1, -4, 2}), 4);
}

}  // namespace
}  // namespace vismat
