// Triangles of outlines that touch, cross and fold back onto themselves, against areas and insides that are computed in
// another way. VISMAT_OUTLINES is their number (40,000; ./check --long takes 1,000,000), a part of it under sanitizers.
#include "visibility/meshes/triangulation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <glm/geometric.hpp>
#include <limits>
#include <string>
#include <vector>

#include "matrix/base/random.h"
#include "tests/sanitized.h"

namespace vismat {
namespace {

using Outline = std::vector<glm::dvec2>;

int outlines() {
  const char* given = std::getenv("VISMAT_OUTLINES");
  const int all = given == nullptr ? 40000 : std::atoi(given);
  return test::sanitized ? all / 20 : all;
}

/// Whether a ray from the point to the right crosses the outline an odd number of times.
bool inside(const Outline& outline, const glm::dvec2& at) {
  bool odd = false;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const glm::dvec2 &p = outline[i], &q = outline[(i + 1) % outline.size()];
    if ((p.y <= at.y) != (q.y <= at.y) && at.x < p.x + (at.y - p.y) * (q.x - p.x) / (q.y - p.y)) odd = !odd;
  }
  return odd;
}

/// By the even-odd rule: the plane is cut into strips between all corners and crossings, in which edges do not cross.
double area_inside(const Outline& outline) {
  std::vector<double> cuts;
  const std::size_t size = outline.size();
  for (std::size_t i = 0; i < size; ++i) {
    cuts.push_back(outline[i].x);
    const glm::dvec2 a = outline[i], ab = outline[(i + 1) % size] - a;
    for (std::size_t k = i + 1; k < size; ++k) {
      const glm::dvec2 c = outline[k], cd = outline[(k + 1) % size] - c;
      const double across = ab.x * cd.y - ab.y * cd.x;
      if (across == 0) continue;
      const double t = ((c.x - a.x) * cd.y - (c.y - a.y) * cd.x) / across;
      const double s = ((c.x - a.x) * ab.y - (c.y - a.y) * ab.x) / across;
      if (t >= 0 && t <= 1 && s >= 0 && s <= 1) cuts.push_back(a.x + t * ab.x);
    }
  }
  std::sort(cuts.begin(), cuts.end());
  double area = 0;
  for (std::size_t cut = 0; cut + 1 < cuts.size(); ++cut) {
    const double left = cuts[cut], right = cuts[cut + 1], middle = (left + right) / 2;
    if (!(right > left)) continue;
    std::vector<double> heights;
    for (std::size_t i = 0; i < size; ++i) {
      const glm::dvec2 &p = outline[i], &q = outline[(i + 1) % size];
      if ((p.x < middle) != (q.x < middle))
        heights.push_back(p.y + (middle - p.x) * (q.y - p.y) / (q.x - p.x));
    }
    std::sort(heights.begin(), heights.end());
    for (std::size_t i = 0; i + 1 < heights.size(); i += 2)
      area += (heights[i + 1] - heights[i]) * (right - left);
  }
  return area;
}

/// The outline lies in the plane through z = height with these slopes; floats of whole numbers stay whole.
void expect_exact_cover(const Outline& outline, const glm::dvec3& slopes, Random& random,
                        const std::string& told) {
  std::vector<glm::vec3> points;
  std::vector<std::uint32_t> numbers, triangles;
  for (const glm::dvec2& p : outline) {
    numbers.push_back(static_cast<std::uint32_t>(points.size()));
    points.emplace_back(p.x, p.y, p.x * slopes.x + p.y * slopes.y + slopes.z);
  }
  Triangulator().add(numbers, points, triangles);
  ASSERT_EQ(triangles.size() % 3, 0u);
  double area = 0;
  std::vector<std::array<glm::dvec2, 3>> flat;
  for (std::size_t t = 0; t < triangles.size(); t += 3) {
    std::array<glm::dvec2, 3> corners;
    for (std::size_t c = 0; c < 3; ++c) {
      ASSERT_LT(triangles[t + c], points.size()) << told;
      corners[c] = glm::dvec2(points[triangles[t + c]]);
    }
    const glm::dvec2 p = corners[1] - corners[0], q = corners[2] - corners[0];
    area += std::abs(p.x * q.y - p.y * q.x) / 2;
    flat.push_back(corners);
  }
  double size = 0;
  for (const glm::dvec2& p : outline) size = std::max({size, std::abs(p.x), std::abs(p.y)});
  EXPECT_NEAR(area, area_inside(outline), 4e-7 * size * size * static_cast<double>(outline.size())) << told;
  for (int trial = 0; trial < 10; ++trial) {
    const glm::dvec2 at((2 * random.fraction() - 1) * size, (2 * random.fraction() - 1) * size);
    int covered = 0;
    bool close = false;  // to the side of a triangle, where crossings were rounded
    for (const auto& t : flat) {
      bool in = true;
      const double turned = (t[1] - t[0]).x * (t[2] - t[0]).y - (t[1] - t[0]).y * (t[2] - t[0]).x;
      for (std::size_t c = 0; c < 3; ++c) {
        const glm::dvec2 side = t[(c + 1) % 3] - t[c], way = at - t[c];
        const double beside = side.x * way.y - side.y * way.x;
        close = close || std::abs(beside) <= 1e-6 * size * glm::length(side);
        in = in && (beside > 0) == (turned > 0);
      }
      covered += in;
    }
    if (!close) {
      EXPECT_EQ(covered, inside(outline, at)) << told << " at " << at.x << ", " << at.y;
    }
  }
}

Outline on_grid(Random& random, int corners, int size) {  // touches and crosses itself everywhere
  Outline outline;
  for (int i = 0; i < corners; ++i) {
    outline.emplace_back(random.below(static_cast<std::uint32_t>(size)),
                         random.below(static_cast<std::uint32_t>(size)));
  }
  return outline;
}

Outline round(Random& random, int corners, double size, double rough) {  // simple: corners by their angle
  Outline outline;
  for (int i = 0; i < corners; ++i) {
    const double angle = 6.283185307179586 * (i + 0.8 * random.fraction()) / corners;
    const double radius = size * (1 - rough * random.fraction());
    outline.emplace_back(std::round(radius * std::cos(angle) * 1024) / 1024,
                         std::round(radius * std::sin(angle) * 1024) / 1024);
  }
  return outline;
}

/// A loop within the outline, joined by a way there and back, or by one of its corners.
Outline bridged(Random& random) {
  Outline outer = round(random, 4 + static_cast<int>(random.below(8)), 8, 0.2);
  Outline inner = round(random, 3 + static_cast<int>(random.below(5)), 3, 0.4);
  if (random.below(2)) std::reverse(inner.begin(), inner.end());
  if (random.below(4) == 0) inner[0] = outer[0];  // no way between
  Outline all = outer;
  all.push_back(outer[0]);
  all.insert(all.end(), inner.begin(), inner.end());
  all.push_back(inner[0]);
  return all;
}

Outline spiky(Random& random) {
  Outline outline;
  for (const glm::dvec2& p : round(random, 4 + static_cast<int>(random.below(6)), 6, 0.5)) {
    outline.push_back(p);
    if (random.below(3) == 0) {  // out and back, perhaps by several steps, perhaps through the inside
      Outline way;
      for (std::uint32_t i = 0; i <= random.below(3); ++i) {
        way.push_back(p + glm::dvec2(random.below(9), random.below(9)) - 4.0);
      }
      outline.insert(outline.end(), way.begin(), way.end());
      for (std::size_t i = way.size() - 1; i-- > 0;) outline.push_back(way[i]);
      outline.push_back(p);
    }
    while (random.below(4) == 0) outline.push_back(p);  // repeated
  }
  return outline;
}

Outline nearly_flat(Random& random) {
  Outline outline;
  const int corners = 3 + static_cast<int>(random.below(8));
  const double height = std::ldexp(1.0, -static_cast<int>(random.below(16)));
  for (int i = 0; i < corners; ++i) outline.emplace_back(random.below(64), height * random.below(3));
  return outline;
}

struct Kind {
  const char* name;
  std::function<Outline(Random&)> make;
};
class Outlines : public testing::TestWithParam<Kind> {};

TEST_P(Outlines, AreCoveredExactly) {
  Random random(7);
  for (int i = 0; i < outlines() / 5; ++i) {
    const Outline outline = GetParam().make(random);
    std::string told = std::to_string(i) + ":";
    for (const glm::dvec2& p : outline) told += " (" + std::to_string(p.x) + ", " + std::to_string(p.y) + ")";
    const glm::dvec3 slopes = i % 2 ? glm::dvec3(0) : glm::dvec3(0.5, -0.25, 3);
    ASSERT_NO_FATAL_FAILURE(expect_exact_cover(outline, slopes, random, told));
    if (HasFailure()) return;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Kinds, Outlines,
    testing::Values(
        Kind{"Touching", [](Random& r) { return on_grid(r, 4 + static_cast<int>(r.below(7)), 4); }},
        Kind{"Crossing", [](Random& r) { return on_grid(r, 4 + static_cast<int>(r.below(9)), 1 << 12); }},
        Kind{"Bridged", bridged}, Kind{"Spiky", spiky}, Kind{"NearlyFlat", nearly_flat}),
    [](const auto& outline) { return std::string(outline.param.name); });

std::vector<std::uint32_t> triangles_of(const Outline& outline) {
  std::vector<glm::vec3> points;
  std::vector<std::uint32_t> numbers, triangles;
  for (const glm::dvec2& p : outline) {
    numbers.push_back(static_cast<std::uint32_t>(points.size()));
    points.emplace_back(p.x, p.y, 0);
  }
  Triangulator().add(numbers, points, triangles);
  return triangles;
}

TEST(Triangulator, KeepsCornersOnStraightLines) {
  std::vector<std::uint32_t> used = triangles_of({{0, 0}, {1, 0}, {2, 0}, {3, 0}, {3, 3}, {0, 3}});
  EXPECT_EQ(used.size(), 4u * 3);
  std::sort(used.begin(), used.end());
  used.erase(std::unique(used.begin(), used.end()), used.end());
  EXPECT_EQ(used.size(), 6u);
}

TEST(Triangulator, ARepeatedOutlineIsOneOutline) {
  EXPECT_EQ(triangles_of({{0, 0}, {2, 0}, {2, 2}, {0, 0}, {2, 0}, {2, 2}}).size(), 3u);
}

TEST(Triangulator, WithoutAreaThereIsOneTriangleWithoutArea) {
  EXPECT_EQ(triangles_of({{0, 0}, {1, 1}, {2, 2}, {1, 1}}).size(), 3u);
  EXPECT_EQ(triangles_of({{1, 1}, {1, 1}, {1, 1}, {1, 1}}).size(), 3u);
}

}  // namespace
}  // namespace vismat
