#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>

#include "visibility/generators/dense_city.h"
#include "visibility/generators/plant.h"
#include "visibility/generators/solids.h"
#include "visibility/geometry/touching_boxes.h"

namespace vismat {
namespace {

/// Each directed edge of an object, by position, meets its opposite once: closed, oriented, and manifold along edges.
void expect_closed(const Scene& scene, std::uint32_t first_object) {
  using Point = std::array<float, 3>;
  const auto point = [&](std::size_t i) {
    const glm::vec3& v = scene.vertices[scene.indices[i]];
    return Point{v.x, v.y, v.z};
  };
  std::vector<double> volume(scene.object_count);
  std::map<Point, std::uint32_t> number;
  std::vector<std::array<std::uint32_t, 3>> edges;  // object, from, to
  for (std::size_t t = 0; t < scene.object_of_triangle.size(); ++t) {
    const std::uint32_t object = scene.object_of_triangle[t];
    std::array<std::uint32_t, 3> corner;
    std::array<glm::dvec3, 3> at;
    for (unsigned i = 0; i < 3; ++i) {
      corner[i] = number.emplace(point(3 * t + i), static_cast<std::uint32_t>(number.size())).first->second;
      at[i] = scene.vertices[scene.indices[3 * t + i]];
    }
    ASSERT_TRUE(corner[0] != corner[1] && corner[1] != corner[2] && corner[2] != corner[0])
        << "triangle " << t;
    volume[object] += glm::dot(at[0], glm::cross(at[1], at[2])) / 6;
    if (object < first_object) continue;
    for (unsigned i = 0; i < 3; ++i) edges.push_back({object, corner[i], corner[(i + 1) % 3]});
  }
  std::sort(edges.begin(), edges.end());
  EXPECT_EQ(std::adjacent_find(edges.begin(), edges.end()), edges.end())
      << "two triangles run along an edge alike";
  for (const auto& [object, from, to] : edges) {
    ASSERT_TRUE(std::binary_search(edges.begin(), edges.end(), std::array{object, to, from}))
        << "object " << object;
  }
  for (std::uint32_t object = first_object; object < scene.object_count; ++object) {
    ASSERT_GT(volume[object], 1e-3) << "object " << object;
  }
}

/// Does a triangle meet the open box? By clipping it against the six sides.
bool enters(const std::array<glm::dvec3, 3>& triangle, const Box& box) {
  for (int axis = 0; axis < 3; ++axis) {
    const auto [low, high] = std::minmax({triangle[0][axis], triangle[1][axis], triangle[2][axis]});
    if (low >= box.high[axis] || high <= box.low[axis]) return false;
  }
  std::vector<glm::dvec3> polygon(triangle.begin(), triangle.end());
  for (int axis = 0; axis < 3; ++axis) {
    for (const double sign : {1., -1.}) {
      const double limit = sign * (sign > 0 ? box.high : box.low)[axis] - 1e-5;
      std::vector<glm::dvec3> rest;
      for (std::size_t i = 0; i < polygon.size(); ++i) {
        const glm::dvec3 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
        const double from = sign * a[axis] - limit, to = sign * b[axis] - limit;
        if (from < 0) rest.push_back(a);
        if ((from < 0) != (to < 0)) rest.push_back(a + (b - a) * (from / (from - to)));
      }
      polygon = std::move(rest);
      if (polygon.empty()) return false;
    }
  }
  return true;
}

void expect_free(const SceneFile& file) {
  const Scene& scene = file.scene;
  for (std::size_t t = 0; t < scene.object_of_triangle.size(); ++t) {
    std::array<glm::dvec3, 3> triangle;
    for (unsigned i = 0; i < 3; ++i) triangle[i] = scene.vertices[scene.indices[3 * t + i]];
    for (const Box& cell : file.cells.boxes) {
      ASSERT_FALSE(enters(triangle, cell)) << "object " << scene.object_of_triangle[t];
    }
  }
}

TEST(Solids, HaveTheirVolume) {
  Scene scene;
  add_box(scene, {{1, 2, 3}, {3, 5, 7}}, 1);
  ++scene.object_count;
  EXPECT_EQ(scene.object_of_triangle.size(), 2u * 2 * (2 * 3 + 3 * 4 + 2 * 4));
  Lattice frame({{{0, 1, 2, 3}, {0, 1}, {0, 1, 2, 3}}}, 10);
  frame.set({{0, 0, 0}, {3, 1, 3}}, true);
  frame.set({{1, 0, 1}, {2, 1, 2}}, false);
  frame.add_to(scene);
  ++scene.object_count;
  const glm::vec3 along(0, 0, 1);
  const std::vector<std::vector<glm::vec3>> rings = {circle({}, along, 1, 64), circle(along, along, 1, 64)};
  add_loft(scene, {}, rings, along);
  ++scene.object_count;
  expect_closed(scene, 0);
  std::array<double, 3> volume{};
  for (std::size_t t = 0; t < scene.object_of_triangle.size(); ++t) {
    const std::uint32_t* i = &scene.indices[3 * t];
    const glm::dvec3 a = scene.vertices[i[0]], b = scene.vertices[i[1]], c = scene.vertices[i[2]];
    volume[scene.object_of_triangle[t]] += glm::dot(a, glm::cross(b, c)) / 6;
  }
  EXPECT_NEAR(volume[0], 24, 1e-9);
  EXPECT_NEAR(volume[1], 8, 1e-9);
  EXPECT_NEAR(volume[2], 32 * std::sin(2 * 3.141592653589793 / 64), 1e-5);
}

DenseCityOptions small_city(std::uint64_t seed) {
  DenseCityOptions options;
  options.size = 5;
  options.car_sides = 12;
  options.interiors = options.car_parks = 0.2f;
  options.seed = seed;
  return options;
}

TEST(DenseCity, ObjectsAreClosedAndOutwardOriented) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    const SceneFile city = make_dense_city(small_city(seed));
    EXPECT_GT(city.scene.object_count, 25u);
    expect_closed(city.scene, 1);
  }
}

TEST(DenseCity, NoObjectEntersAViewCell) {
  const SceneFile city = make_dense_city(small_city(4));
  EXPECT_GE(city.cells.count(), 25u * 9);  // the streets alone
  EXPECT_EQ(city.cells.neighbours, touching_boxes(city.cells.boxes));
  expect_free(city);
}

TEST(DenseCity, SameSeedSameCity) {
  const SceneFile one = make_dense_city(small_city(1)), same = make_dense_city(small_city(1)),
                  other = make_dense_city(small_city(2));
  EXPECT_EQ(one.scene.vertices, same.scene.vertices);
  EXPECT_EQ(one.scene.indices, same.scene.indices);
  EXPECT_NE(one.scene.vertices, other.scene.vertices);
}

TEST(DenseCity, HasTheSizeOfTheBenchmark) {
  const SceneFile city = make_dense_city();
  EXPECT_GT(city.scene.object_of_triangle.size(), 800000u);
  EXPECT_LT(city.scene.object_of_triangle.size(), 1250000u);
  EXPECT_LT(city.scene.object_count, 4000u);
}

TEST(DenseCity, WrongOptionsAreRefused) {
  DenseCityOptions options;
  options.largest_side = 19;
  EXPECT_THROW(make_dense_city(options), std::invalid_argument);
  options = {};
  options.size = 0;
  EXPECT_THROW(make_dense_city(options), std::invalid_argument);
  options = {};
  options.step = std::nanf("");
  EXPECT_THROW(make_dense_city(options), std::invalid_argument);
}

PlantOptions small_plant(std::uint64_t seed) {
  PlantOptions options;
  options.size = 2;
  options.seed = seed;
  return options;
}

TEST(Plant, ComponentsAreClosedAndOutwardOriented) {
  for (const std::uint64_t seed : {1, 2}) {
    const SceneFile plant = make_plant(small_plant(seed), 1);
    EXPECT_GT(plant.scene.object_count, 500u);
    expect_closed(plant.scene, 1);
  }
}

TEST(Plant, SameForAnyNumberOfThreads) {
  const SceneFile one = make_plant(small_plant(1), 1), same = make_plant(small_plant(1), 3);
  EXPECT_EQ(one.scene.vertices, same.scene.vertices);
  EXPECT_EQ(one.scene.indices, same.scene.indices);
  EXPECT_EQ(one.cells.boxes, same.cells.boxes);
  EXPECT_GT(one.cells.count(), 50u);
}

TEST(Plant, WrongOptionsAreRefused) {
  PlantOptions options;
  options.bay = 5;
  EXPECT_THROW(make_plant(options), std::invalid_argument);
  options = {};
  options.pipes = std::nanf("");
  EXPECT_THROW(make_plant(options), std::invalid_argument);
}

}  // namespace
}  // namespace vismat
