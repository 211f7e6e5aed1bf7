#include <gmpxx.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "matrix/base/random.h"
#include "tests/visibility/analytic_scenes.h"
#include "visibility/exact/line_space.h"

namespace vismat {
namespace {

TEST(Predicates, OrientationIsRightWhereDoublesAreNot) {
  // Along the plane z = x + y, off it by the last bit: what doubles make of it is noise.
  Random random(1);
  const auto exact = [](const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const glm::dvec3& d) {
    mpq_class m[3][3];
    int row = 0;
    for (const glm::dvec3* p : {&b, &c, &d}) {
      for (int k = 0; k < 3; ++k) m[row][k] = mpq_class((*p)[k]) - mpq_class(a[k]);
      ++row;
    }
    const mpq_class det = m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
                          m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
                          m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
    return sgn(det);
  };
  int signs[3] = {};
  for (int i = 0; i < 2000; ++i) {
    std::array<glm::dvec3, 4> p;
    for (glm::dvec3& point : p) {
      point = {random.fraction() + 1e5, random.fraction(), 0};
      point.z = point.x + point.y;
      if (random.below(2) == 0) point.z = std::nextafter(point.z, random.below(2) == 0 ? 0 : 1e9);
    }
    const int expected = exact(p[0], p[1], p[2], p[3]);
    ++signs[expected + 1];
    ASSERT_EQ(orientation(p[0], p[1], p[2], p[3]), expected);
    ASSERT_EQ(orientation(p[1], p[0], p[2], p[3]), -expected);
  }
  EXPECT_GT(signs[0], 100);
  EXPECT_GT(signs[2], 100);
  EXPECT_EQ(orientation({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 5e-324}), 1);
  EXPECT_EQ(orientation({0, 0, 0}, {1e-200, 0, 0}, {0, 1e-200, 0}, {0, 0, -1e-200}), -1);
}

TEST(Predicates, SegmentAndTriangle) {
  const Triangle t = {{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}};
  EXPECT_TRUE(crosses({1, 1, -1}, {1, 1, 1}, t));
  EXPECT_TRUE(crosses({1, 1, 1}, {1, 1, -1}, t));   // from the other side
  EXPECT_FALSE(crosses({3, 3, -1}, {3, 3, 1}, t));  // past it
  EXPECT_FALSE(crosses({1, 1, 1}, {1, 1, 2}, t));   // above it
  EXPECT_TRUE(crosses({2, 2, -1}, {2, 2, 1}, t));   // through an edge
  EXPECT_TRUE(crosses({0, 0, -1}, {0, 0, 1}, t));   // through a corner
  EXPECT_FALSE(crosses({1, 1, 0}, {1, 1, 1}, t));   // begins on it
  EXPECT_FALSE(crosses({1, 1, 1}, {1, 1, 0}, t));   // ends on it
  EXPECT_TRUE(crosses({-1, 1, 0}, {9, 1, 0}, t));   // within its plane
  EXPECT_TRUE(crosses({-1, 0, 0}, {9, 0, 0}, t));   // along its edge
  EXPECT_TRUE(crosses({1, 1, 0}, {1.5, 1, 0}, t));  // inside
  EXPECT_TRUE(crosses({-1, 4, 0}, {1, 4, 0}, t));   // through a corner within the plane
  EXPECT_FALSE(crosses({-1, 5, 0}, {9, 5, 0}, t));  // past it within the plane
  EXPECT_FALSE(crosses({-1, 1, 0}, {0, 1, 0}, t));  // ends on its edge within the plane
  EXPECT_FALSE(crosses({0, 1, 0}, {-1, 1, 0}, t));  // begins there
  EXPECT_FALSE(crosses({1, 1, 0}, {1, 1, 0}, t));   // no segment
  const Triangle needle = {{{0, 0, 0}, {1, 1, 1}, {2, 2, 2}}};
  EXPECT_FALSE(crosses({0, 2, 1}, {2, 0, 1}, needle));  // no triangle
  EXPECT_FALSE(crosses({0, 0, 0}, {2, 2, 2}, needle));
}

TEST(Predicates, MeansAreExact) {
  // A third of the way along an edge is no double, yet lies on it.
  const Triangle t = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}, behind = {{{0, 0, -1}, {1, 0, -1}, {0, 1, -1}}};
  const WeightedMean on_edge{{t[0], t[1]}, {2, 1}}, above{{{0.25, 0, 1}}, {1}},
      below{{t[0], t[1], {0, 0, -2}}, {2, 1, 3}};
  EXPECT_EQ(first_crossed(above, on_edge, std::array<Triangle, 1>{t}), 1u);
  EXPECT_EQ(first_crossed(above, below, std::array<Triangle, 2>{behind, t}), 1u);
}

TEST(Predicates, TriangleAndSolid) {
  const Convex box = convex_box({{0, 0, 0}, {1, 1, 1}});
  EXPECT_TRUE(meets({{{.2, .2, .2}, {.3, .2, .2}, {.2, .3, .2}}}, box));  // inside
  EXPECT_TRUE(meets({{{-9, -9, .5}, {9, -9, .5}, {0, 9, .5}}}, box));     // all around
  EXPECT_TRUE(meets({{{1, 1, 1}, {2, 1, 1}, {1, 2, 1}}}, box));           // a corner
  EXPECT_FALSE(meets({{{1.5, 1.5, 0}, {3, 0, 0}, {0, 3, 0}}},
                     convex_box({{0, 0, 0}, {1, 1, 0}})));  // past it in its plane
  EXPECT_FALSE(meets({{{0, 0, 1.0000001}, {1, 0, 1.0000001}, {0, 1, 1.0000001}}}, box));
  EXPECT_TRUE(meets({{{-1, -1, 0}, {2, 0, 0}, {0, 2, 0}}}, convex_box({{0, 0, 0}, {0, 0, 0}})));  // a point
}

// The claim of hides(): what its nine segments say holds for all others.
TEST(Predicates, WhatVerticesCannotSeeIsHidden) {
  Random random(3);
  const auto point = [&](double y) {
    return glm::dvec3(8 * random.fraction(), y + 3 * random.fraction(), 8 * random.fraction());
  };
  int hidden = 0;
  for (int i = 0; i < 20000; ++i) {
    const Triangle a = {point(0), point(0), point(0)}, b = {point(20), point(20), point(20)};
    const std::array<float, 3> low = {4 * random.unit(), 8 + 4 * random.unit(), 4 * random.unit()};
    const Convex solid =
        convex_box({low, {low[0] + 6 * random.unit(), low[1] + 1, low[2] + 6 * random.unit()}});
    if (!hides(solid, a, b)) continue;
    ++hidden;
    const auto inner = [&](const Triangle& t) {
      const double u = random.fraction(), v = random.fraction() * (1 - u);
      return t[0] + u * (t[1] - t[0]) + v * (t[2] - t[0]);
    };
    for (int k = 0; k < 20; ++k) ASSERT_TRUE(crosses(inner(a), inner(b), solid));
  }
  EXPECT_GT(hidden, 200);
}

TEST(LineSpace, AnalyticScenes) {
  for (const AnalyticScene& s : analytic_scenes()) {
    SCOPED_TRACE(s.name);
    const Convex cell = convex_box(s.cell);
    for (std::uint32_t object = 0; object < s.scene.object_count; ++object) {
      const LineSpaceAnswer answer = look_in_line_space(s.scene, s.occluders, cell, object);
      EXPECT_EQ(answer.visibility, s.truth[object] == Truth::seen ? Visibility::visible : Visibility::hidden)
          << "object " << object << " after " << answer.pieces << " pieces";
    }
  }
}

// What the table calls hidden is hidden point by point, each by one occluder from the whole cell; what it calls hidden
// jointly is not.
TEST(LineSpace, WhichHiddenObjectsNeedSeveralOccluders) {
  Random random(5);
  for (const AnalyticScene& s : plain_analytic_scenes()) {
    SCOPED_TRACE(s.name);
    const std::vector<glm::dvec3> cell = convex_box(s.cell).vertices;
    std::vector<int> in_no_umbra(s.scene.object_count);
    for (std::size_t t = 0; t < s.scene.object_of_triangle.size(); ++t) {
      const std::uint32_t object = s.scene.object_of_triangle[t];
      const auto corner = [&](std::size_t i) {
        return glm::dvec3(s.scene.vertices[s.scene.indices[3 * t + i]]);
      };
      for (int k = 0; k < 20; ++k) {
        const double u = random.fraction(), v = random.fraction() * (1 - u);
        const glm::dvec3 x = corner(0) + u * (corner(1) - corner(0)) + v * (corner(2) - corner(0));
        in_no_umbra[object] += std::none_of(s.occluders.begin(), s.occluders.end(), [&](const Occluder& o) {
          return o.object != object && hides(o.shape, cell, std::array{x});
        });
      }
    }
    for (std::uint32_t object = 0; object < s.scene.object_count; ++object) {
      if (s.truth[object] == Truth::seen) continue;
      EXPECT_EQ(in_no_umbra[object] > 0, s.truth[object] == Truth::hidden_jointly) << "object " << object;
    }
  }
}

}  // namespace
}  // namespace vismat
