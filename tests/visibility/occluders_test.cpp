#include "visibility/shadows/occluders.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <string>

#include "matrix/base/random.h"
#include "tests/visibility/occluder_scenes.h"
#include "visibility/generators/city.h"

namespace vismat {
namespace {

using glm::dvec3;

bool all(int, int, int) {
  return true;
}

Place scaled(const dvec3& factor) {
  return [=](const dvec3& p) { return p * factor; };
}
/// Turned about z, then moved.
Place turned(const Place& place, double angle, const dvec3& by) {
  return [=](const dvec3& p) {
    const dvec3 q = place(p);
    const double c = std::cos(angle), s = std::sin(angle);
    return dvec3(c * q.x - s * q.y, s * q.x + c * q.y, q.z) + by;
  };
}
/// Turned about x as well.
Place tilted(const Place& place, double angle) {
  return [=](const dvec3& p) {
    const dvec3 q = turned(place, angle, {})(p);
    const double c = std::cos(angle), s = std::sin(angle);
    return dvec3(q.x, c * q.y - s * q.z, s * q.y + c * q.z);
  };
}

OccluderOptions as_they_are() {
  OccluderOptions options;
  options.extend_below_ground = false;
  return options;
}

bool holds(const Occluder& occluder, const dvec3& point) {
  for (const Convex::Face& face : occluder.shape.faces) {
    if (glm::dot(face.normal, point) > face.offset) return false;
  }
  return true;
}

/// The share of a lattice's filled cubes that occluders hold, by points in them.
double share_held(const std::vector<Occluder>& occluders, glm::ivec3 lattice,
                  const std::function<bool(int, int, int)>& filled, const Place& place) {
  Random random(1);
  unsigned held = 0, count = 0;
  while (count < 2000) {
    const dvec3 p(lattice.x * random.fraction(), lattice.y * random.fraction(),
                  lattice.z * random.fraction());
    if (!filled(static_cast<int>(p.x), static_cast<int>(p.y), static_cast<int>(p.z))) continue;
    ++count;
    held += std::any_of(occluders.begin(), occluders.end(),
                        [&](const Occluder& o) { return holds(o, place(p)); });
  }
  return held / 2000.0;
}

double area(const Convex& polygon) {
  dvec3 sum{};
  for (std::size_t i = 1; i + 1 < polygon.vertices.size(); ++i) {
    sum +=
        glm::cross(polygon.vertices[i] - polygon.vertices[0], polygon.vertices[i + 1] - polygon.vertices[0]);
  }
  return glm::length(sum) / 2;
}

struct Solid {
  std::string name;
  glm::ivec3 lattice;
  std::function<bool(int, int, int)> filled;
  double least_share;  // held by occluders, where axes are square or turned about z
};

std::vector<Solid> solids() {
  return {{"box", {5, 4, 9}, all, 0.999},
          {"dent", {5, 5, 5}, [](int x, int y, int z) { return !(x == 2 && y == 2 && z == 4); }, 0.99},
          {"L", {6, 6, 4}, [](int x, int y, int) { return x < 2 || y < 2; }, 0.999},
          {"U", {6, 6, 4}, [](int x, int y, int) { return x < 2 || x > 3 || y < 2; }, 0.999},
          {"frame", {7, 1, 7}, [](int x, int, int z) { return x == 0 || x == 6 || z == 0 || z == 6; }, 0.999},
          {"hollow building with a door",
           {8, 8, 6},
           [](int x, int y, int z) {
             const bool wall = x == 0 || y == 0 || z == 0 || x == 7 || y == 7 || z == 5;
             return wall && !(y == 0 && x == 3 && (z == 1 || z == 2));
           },
           0.9},
          {"hollow without a door",
           {6, 6, 6},
           [](int x, int y, int z) { return x == 0 || y == 0 || z == 0 || x == 5 || y == 5 || z == 5; },
           0.999},
          {"cubes that touch along an edge",
           {4, 4, 3},
           [](int x, int y, int) { return (x < 2) == (y < 2); },
           0.999}};
}

TEST(Occluders, WhatIsInsideOfSolidsAndHowMuchOfThem) {
  for (const Solid& solid : solids()) {
    const Place place = scaled({2, 2, 2});
    for (const Place& how : {place, turned(place, 0.4, {100, -50, 3}), turned(place, -0.7, {1e5, 1e5, 0})}) {
      Scene scene;
      add_cubes(scene, solid.lattice, solid.filled, how);
      const std::vector<Occluder> found = find_occluders(scene, as_they_are());
      for (const Occluder& occluder : found) EXPECT_FALSE(occluder.flat) << solid.name;
      EXPECT_GE(share_held(found, solid.lattice, solid.filled, how),
                solid.least_share - (how({0, 0, 0}).x > 9e4 ? 0.1 : 0))
          << solid.name << " at " << how({0, 0, 0}).x;
      EXPECT_EQ(find_leak(scene, found, 1000, 1), std::nullopt) << solid.name << " at " << how({0, 0, 0}).x;
      EXPECT_EQ(find_leak(scene, find_occluders(scene), 1000, 2), std::nullopt) << solid.name << ", extended";
    }
    Scene scene;
    add_cubes(scene, solid.lattice, solid.filled, tilted(place, 0.3));
    const std::vector<Occluder> found = find_occluders(scene);
    EXPECT_FALSE(found.empty()) << solid.name;
    EXPECT_EQ(find_leak(scene, found, 1000, 3), std::nullopt) << solid.name << ", tilted";
  }
}

TEST(Occluders, ATessellatedBoxIsOneSolidWithSixFaces) {
  for (const Place& place : {scaled({1.2, 1.2, 1.2}), turned(scaled({1.2, 1.2, 1.2}), 0.5, {70, 30, 0})}) {
    Scene scene;
    add_cubes(scene, {10, 10, 20}, all, place);
    const std::vector<Occluder> found = find_occluders(scene, as_they_are());
    ASSERT_EQ(found.size(), 1u);
    EXPECT_EQ(found[0].shape.faces.size(), 6u);
    EXPECT_EQ(found[0].shape.vertices.size(), 8u);
    for (const dvec3& vertex : found[0].shape.vertices) {
      double nearest = 1;
      for (unsigned corner = 0; corner < 8; ++corner) {
        const dvec3 at = place({corner & 1 ? 10 : 0, corner & 2 ? 10 : 0, corner & 4 ? 20 : 0});
        nearest = std::min(nearest, glm::distance(at, vertex));
      }
      EXPECT_LT(nearest, 1e-4);
    }
  }
}

TEST(Occluders, WhichWayTrianglesAreTurnedDoesNotMatter) {
  for (const Solid& solid : solids()) {
    // No telling where a side has four triangles, nor which of two shells is the inner side of a wall.
    if (solid.name == "cubes that touch along an edge" || solid.name == "hollow without a door") continue;
    Scene scene;
    add_cubes(scene, solid.lattice, solid.filled, scaled({2, 2, 2}));
    const std::vector<Occluder> found = find_occluders(scene);
    Random random(1);
    for (std::size_t t = 0; t < scene.object_of_triangle.size(); ++t) {
      if (random.below(2)) std::swap(scene.indices[3 * t], scene.indices[3 * t + 1]);
    }
    const std::vector<Occluder> again = find_occluders(scene);
    ASSERT_EQ(again.size(), found.size()) << solid.name;
    EXPECT_EQ(std::count_if(again.begin(), again.end(), [](const Occluder& o) { return o.flat; }), 0)
        << solid.name;
    EXPECT_EQ(find_leak(scene, again, 300, 1), std::nullopt) << solid.name;
  }
}

TEST(Occluders, WhatStandsOnTheLowestPlaneReachesFarBelowIt) {
  for (const double angle : {0.0, 0.5}) {
    Scene scene;
    add_cubes(scene, {4, 4, 8}, all, turned(scaled({3, 3, 3}), angle, {20, 10, -5}));
    add_cubes(
        scene, {6, 6, 4}, [](int x, int y, int) { return x < 2 || y < 2; },
        turned(scaled({3, 3, 3}), angle, {60, 10, -5}));
    add_cubes(scene, {2, 2, 2}, all, turned(scaled({3, 3, 3}), angle, {90, 10, -4}));  // floats
    add_squares(
        scene, 9, 5, [](int, int) { return true; },
        turned([](const dvec3& p) { return dvec3(2 * p.x, 0, 2 * p.y); }, angle, {0, 90, -5}));
    EXPECT_EQ(lowest_point(scene), -5);
    std::vector<double> lowest(4, 0);
    for (const Occluder& occluder : find_occluders(scene)) {
      for (const dvec3& vertex : occluder.shape.vertices)
        lowest[occluder.object] = std::min(lowest[occluder.object], vertex.z);
    }
    EXPECT_LT(lowest[0], -80) << angle;
    EXPECT_LT(lowest[1], -80) << angle;
    EXPECT_NEAR(lowest[2], -4, 1e-4) << angle;
    EXPECT_LT(lowest[3], -80) << angle;
  }
}

TEST(Occluders, NothingBlocksFromInsideUnlessItIsAWallThere) {
  Scene scene;  // a wall of two shells, one in the other
  const Place place = scaled({2, 2, 2});
  add_cubes(
      scene, {6, 6, 6},
      [](int x, int y, int z) { return x == 0 || y == 0 || z == 0 || x == 5 || y == 5 || z == 5; }, place);
  const std::vector<Occluder> found = find_occluders(scene, as_they_are());
  const auto blocking = [&](const Box& cell) {
    return std::count_if(found.begin(), found.end(),
                         [&](const Occluder& o) { return o.within && blocks_from(o, convex_box(cell)); });
  };
  const auto boxes =
      std::count_if(found.begin(), found.end(), [](const Occluder& o) { return o.within != nullptr; });
  EXPECT_GE(boxes, 6);
  EXPECT_EQ(blocking({{5, 5, 5}, {7, 7, 7}}), boxes) << "in the room";
  EXPECT_EQ(blocking({{5, 5, 20}, {7, 7, 22}}), boxes) << "outside";
  EXPECT_EQ(blocking({{5, 5, 0.5f}, {7, 7, 1}}), 0) << "in the floor";
  EXPECT_EQ(blocking({{5, 5, 1}, {7, 7, 3}}), 0) << "half in the floor";
  EXPECT_EQ(blocking({{5, 5, 1}, {5, 5, 1}}), 0) << "a point in the floor";
}

TEST(Occluders, ATorusIsNotFilled) {
  for (const Place& place : {scaled({1, 1, 1}), tilted(scaled({1, 1, 1}), 0.6)}) {
    Scene scene;
    add_torus(scene, 5, 2, 48, 24, place);
    const std::vector<Occluder> found = find_occluders(scene);
    EXPECT_GE(found.size(), 4u);
    for (const Occluder& occluder : found) EXPECT_FALSE(holds(occluder, place({0, 0, 0})));
    EXPECT_EQ(find_leak(scene, found, 3000, 1), std::nullopt);
  }
}

TEST(Occluders, AWallWithAWindowLeavesItFree) {
  const auto filled = [](int u, int v) { return !(u >= 4 && u < 7 && v >= 3 && v < 6); };
  const auto upright = [](const dvec3& p) { return dvec3(p.x, 3, p.y); };
  for (const Place& place : {Place(upright), turned(upright, 0.3, {50, 60, 0}), tilted(upright, 0.4),
                             turned(upright, 0.3, {3e4, 3e4, 0})}) {
    Scene scene;
    add_squares(scene, 12, 9, filled, place);
    const std::vector<Occluder> found = find_occluders(scene, as_they_are());
    double covered = 0;
    for (const Occluder& occluder : found) {
      EXPECT_TRUE(occluder.flat);
      covered += area(occluder.shape);
    }
    EXPECT_GE(covered, 85) << "of 99 square metres";
    EXPECT_EQ(find_leak(scene, found, 5000, 1), std::nullopt) << place({0, 0, 0}).x;
    EXPECT_EQ(find_leak(scene, find_occluders(scene), 5000, 1), std::nullopt)
        << place({0, 0, 0}).x << ", extended";
  }
}

TEST(Occluders, FlatFacesBecomeOnePolygon) {
  Scene scene;
  add_squares(
      scene, 8, 6, [](int, int) { return true; },
      [](const dvec3& p) { return dvec3(p.x, p.y, 0.5 * p.x + 0.25 * p.y); });
  std::vector<Occluder> found = find_occluders(scene, as_they_are());
  ASSERT_EQ(found.size(), 1u) << "exactly coplanar: seen from both sides";
  EXPECT_EQ(found[0].shape.vertices.size(), 4u);
  EXPECT_NEAR(area(found[0].shape), 48 * std::sqrt(1 + 0.25 + 0.0625), 1e-3);
  EXPECT_EQ(find_leak(scene, found, 3000, 1), std::nullopt);
}

TEST(Occluders, GlassSliversAndWhatIsNotFiniteHideNothing) {
  Scene scene;
  add_cubes(scene, {2, 2, 2}, all, scaled({3, 3, 3}));
  scene.see_through = {1};
  EXPECT_TRUE(find_occluders(scene).empty());

  Scene needles;
  ++needles.object_count;
  Random random(3);
  for (std::uint32_t i = 0; i < 300; ++i) {
    const glm::vec3 at(random.between(0, 9), random.between(0, 9), random.between(0, 9));
    needles.vertices.insert(needles.vertices.end(),
                            {at, at + glm::vec3(9, 4, 2), at + glm::vec3(4.5f, 2, 1.00001f)});
    needles.indices.insert(needles.indices.end(), {3 * i, 3 * i + 1, 3 * i + 2});
    needles.object_of_triangle.push_back(0);
  }
  EXPECT_TRUE(find_occluders(needles).empty());

  scene.see_through.clear();
  scene.vertices[0].x = std::nanf("");
  EXPECT_TRUE(find_occluders(scene).empty());
  EXPECT_TRUE(find_occluders(Scene{}).empty());
}

TEST(Occluders, SoupsOfLargeTrianglesAreTheirTriangles) {
  Scene scene;
  Random random(5);
  for (std::uint32_t i = 0; i < 200; ++i) {
    ++scene.object_count;
    for (int corner = 0; corner < 3; ++corner) {
      scene.vertices.emplace_back(random.between(0, 30), random.between(0, 30), random.between(0, 30));
      scene.indices.push_back(3 * i + corner);
    }
    scene.object_of_triangle.push_back(i);
  }
  const std::vector<Occluder> found = find_occluders(scene);
  EXPECT_GE(found.size(), 195u);
  EXPECT_LE(found.size(), 200u);
  EXPECT_EQ(find_leak(scene, found, 300, 1), std::nullopt);
}

TEST(Occluders, BoxesOfTheCityForAnyNumberOfThreads) {
  CityOptions options;
  options.size = 8;
  const Scene scene = make_city(options).scene;
  OccluderOptions one, three;
  one.threads = 1, three.threads = 3;
  const std::vector<Occluder> found = find_occluders(scene, one), again = find_occluders(scene, three);
  ASSERT_EQ(found.size(), 64u);
  ASSERT_EQ(again.size(), 64u);
  for (std::uint32_t i = 0; i < 64; ++i) {
    EXPECT_EQ(found[i].object, i);
    EXPECT_EQ(found[i].shape.vertices, again[i].shape.vertices);
  }
  EXPECT_EQ(find_leak(scene, found, 500, 1), std::nullopt);
}

}  // namespace
}  // namespace vismat
