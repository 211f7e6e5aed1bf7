#include "visibility/meshes/octants.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <glm/geometric.hpp>
#include <set>
#include <vector>

#include "matrix/base/random.h"
#include "tests/refusal.h"

namespace vismat {
namespace {

using test::refusal;

void add_triangle(Scene& scene, const std::array<glm::vec3, 3>& corners) {
  for (const glm::vec3& corner : corners) {
    scene.indices.push_back(static_cast<std::uint32_t>(scene.vertices.size()));
    scene.vertices.push_back(corner);
  }
  scene.object_of_triangle.push_back(scene.object_count++);
}

Scene random_triangles(std::uint32_t count) {
  Scene scene;
  Random random(3);
  for (std::uint32_t i = 0; i < count; ++i) {
    std::array<glm::vec3, 3> corners;
    for (glm::vec3& corner : corners) corner = {9 * random.unit(), 7 * random.unit(), 5 * random.unit()};
    add_triangle(scene, corners);
  }
  return scene;
}

/// A closed solid, none of whose corners lies on a round coordinate.
Scene slanted_solid() {
  constexpr std::uint32_t faces[][3] = {{0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}, {0, 1, 5}, {0, 5, 4},
                                        {2, 6, 7}, {2, 7, 3}, {0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}};
  Scene scene;
  const glm::vec3 x(7, 1.3f, .4f), y(-2, 6, .7f), z(.6f, -1.1f, 5);
  for (unsigned c = 0; c < 8; ++c)
    scene.vertices.push_back(glm::vec3(.1f) + (c & 1 ? x : glm::vec3(0)) + (c & 2 ? y : glm::vec3(0)) +
                             (c & 4 ? z : glm::vec3(0)));
  for (const auto& face : faces) {
    scene.indices.insert(scene.indices.end(), std::begin(face), std::end(face));
    scene.object_of_triangle.push_back(0);
  }
  scene.object_count = 1;
  return scene;
}

double area_of(const std::array<glm::vec3, 3>& t) {
  return glm::length(glm::cross(glm::dvec3(t[1]) - glm::dvec3(t[0]), glm::dvec3(t[2]) - glm::dvec3(t[0]))) /
         2;
}

/// Whether one of many points spread evenly over the triangle lies within the box.
bool has_point_within(const std::array<glm::vec3, 3>& t, const Box& box) {
  constexpr int steps = 60;
  for (int i = 1; i < steps; ++i) {
    for (int j = 1; i + j < steps; ++j) {
      const glm::dvec3 p = glm::dvec3(t[0]) + (glm::dvec3(t[1]) - glm::dvec3(t[0])) * (1. * i / steps) +
                           (glm::dvec3(t[2]) - glm::dvec3(t[0])) * (1. * j / steps);
      bool within = true;
      for (unsigned axis = 0; axis < 3; ++axis) {
        const double at = p[static_cast<int>(axis)];
        within = within && box.low[axis] < at && at < box.high[axis];
      }
      if (within) return true;
    }
  }
  return false;
}

TEST(Octants, HoldTheWholeSurfaceEachItsPart) {
  const Scene scene = random_triangles(40);
  const Octants octants = cut_into_octants(scene, 10'000, 3);
  ASSERT_EQ(octants.levels, 3u);
  ASSERT_EQ(octants.octant_of_object.size(), octants.scene.object_count);
  double before = 0, after = 0;
  for (std::size_t t = 0; t < scene.object_of_triangle.size(); ++t) before += area_of(corners_of(scene, t));
  for (std::size_t t = 0; t < octants.scene.object_of_triangle.size(); ++t) {
    const auto corners = corners_of(octants.scene, t);
    after += area_of(corners);
    const Box& box = octants.boxes[octants.octant_of_object[octants.scene.object_of_triangle[t]]];
    for (const glm::vec3& corner : corners) {
      for (int axis = 0; axis < 3; ++axis) {
        const auto a = static_cast<unsigned>(axis);
        ASSERT_TRUE(box.low[a] <= corner[axis] && corner[axis] <= box.high[a]) << "triangle " << t;
      }
    }
  }
  EXPECT_NEAR(after, before, 1e-5 * before);
}

TEST(Octants, AreThoseWhereSomeTriangleLies) {
  const Scene scene = random_triangles(12);
  const Octants octants = cut_into_octants(scene, 10'000, 3);
  std::set<std::array<float, 3>> occupied;
  for (const Box& box : octants.boxes) occupied.insert(box.low);
  ASSERT_EQ(occupied.size(), octants.count());
  const Box bounds = bounds_of(scene);
  double side = 0;
  for (unsigned axis = 0; axis < 3; ++axis)
    side = std::max(side, double{bounds.high[axis]} - double{bounds.low[axis]});
  for (unsigned i = 0; i < 512; ++i) {
    Box box;
    for (unsigned axis = 0; axis < 3; ++axis) {
      const unsigned place = i >> 3 * axis & 7;
      box.low[axis] = static_cast<float>(double{bounds.low[axis]} + side * place / 8);
      box.high[axis] = static_cast<float>(double{bounds.low[axis]} + side * (place + 1) / 8);
    }
    bool any = false;
    for (std::size_t t = 0; t < scene.object_of_triangle.size() && !any; ++t)
      any = has_point_within(corners_of(scene, t), box);
    if (!any) continue;  // points miss the smallest corners
    EXPECT_TRUE(occupied.contains(box.low)) << "octant " << i;
  }
}

TEST(Octants, StandInZOrderUnderTheirPaths) {
  const Octants octants = cut_into_octants(random_triangles(40), 10'000, 2);
  const float root = octants.boxes[0].high[0] - octants.boxes[0].low[0];
  EXPECT_TRUE(std::is_sorted(octants.paths.begin(), octants.paths.end()));
  EXPECT_TRUE(std::is_sorted(octants.octant_of_object.begin(), octants.octant_of_object.end()));
  const Box bounds = bounds_of(random_triangles(40));
  for (std::uint32_t o = 0; o < octants.count(); ++o) {
    ASSERT_EQ(octants.paths[o].size(), 2u);
    for (unsigned axis = 0; axis < 3; ++axis) {
      const int place =
          2 * ((octants.paths[o][0] - '0') >> axis & 1) + ((octants.paths[o][1] - '0') >> axis & 1);
      EXPECT_NEAR(octants.boxes[o].low[axis], bounds.low[axis] + root * static_cast<float>(place), 1e-4);
    }
  }
}

TEST(Octants, LeaveNoCracks) {
  const Scene cut = cut_into_octants(slanted_solid(), 10'000, 4).scene;
  std::multiset<std::array<std::uint32_t, 2>> edges;
  for (std::size_t i = 0; i < cut.indices.size(); ++i)
    edges.insert({cut.indices[i], cut.indices[i % 3 == 2 ? i - 2 : i + 1]});
  ASSERT_GT(edges.size(), 1000u);
  std::size_t open = 0;
  for (const auto& [from, to] : edges) open += edges.count({to, from}) != 1;
  EXPECT_EQ(open, 0u) << "of " << edges.size() << " edges";
}

TEST(Octants, AreAtMostSoMany) {
  const Scene scene = random_triangles(40);
  const Octants few = cut_into_octants(scene, 100);
  EXPECT_LE(few.count(), 100u);
  EXPECT_GT(cut_into_octants(scene, 10'000, few.levels + 1).count(), 100u);
  EXPECT_EQ(cut_into_octants(scene, 100, 0).count(), 1u);
  const Box bounds = bounds_of(scene), larger = cut_into_octants(scene, 1, 0, 1.5).boxes[0];
  EXPECT_EQ(larger.low, bounds.low);
  EXPECT_NEAR(larger.high[0] - larger.low[0], 1.5f * (bounds.high[0] - bounds.low[0]), 1e-3);
}

TEST(Octants, KeepApartWhatCanBeSeenThrough) {
  Scene scene;
  for (const float x : {1.f, 1.5f, 9.f}) add_triangle(scene, {{{x, 1, 1}, {x, 2, 1}, {x, 1, 2}}});
  add_triangle(scene, {{{0, 0, 0}, {.1f, 0, 0}, {0, .1f, 0}}});
  scene.see_through = {0, 1, 1, 0};
  const Octants octants = cut_into_octants(scene, 8, 1);
  EXPECT_EQ(octants.count(), 2u);
  EXPECT_EQ(octants.octant_of_object, (std::vector<std::uint32_t>{0, 0, 1}));
  EXPECT_EQ(octants.scene.see_through, (std::vector<std::uint8_t>{0, 1, 1}));
}

TEST(Octants, TakeWhatLiesBetweenTwoIntoTheLower) {
  Scene scene;
  add_triangle(scene, {{{4, 0, 0}, {4, 1, 0}, {4, 0, 1}}});
  add_triangle(scene, {{{0, 0, 0}, {0, 8, 0}, {8, 0, 0}}});
  add_triangle(scene, {{{7, 0, 0}, {7, 0, 0}, {7, 1, 1}}});  // without area
  const Octants octants = cut_into_octants(scene, 8, 1);
  EXPECT_EQ(octants.paths, (std::vector<std::string>{"0", "1", "2"}));
  EXPECT_EQ(octants.scene.object_of_triangle[1], 0u);
}

TEST(Octants, RefuseWhatCannotBe) {
  const Scene scene = random_triangles(2);
  EXPECT_EQ(refusal<std::invalid_argument>([&] { cut_into_octants(scene, 0); }),
            "octants: at most 0; need 1 or more");
  EXPECT_EQ(refusal<std::invalid_argument>([&] { cut_into_octants(scene, 9, 21); }),
            "octants: 21 levels; at most 20 can be divided");
  EXPECT_EQ(refusal<std::invalid_argument>([&] { cut_into_octants(scene, 9, 2, .5); }),
            "octants: the scale is 1 to 1000");
  Scene flat;
  add_triangle(flat, {{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}});
  EXPECT_EQ(refusal<std::invalid_argument>([&] { cut_into_octants(flat, 9); }),
            "octants: no triangle of the scene has an area");
}

}  // namespace
}  // namespace vismat
