#include "visibility/detail/levels_of_detail.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <numeric>
#include <stdexcept>

#include "matrix/base/random.h"
#include "tests/sanitized.h"
#include "visibility/detail/back_faces.h"
#include "visibility/generators/dense_city.h"
#include "visibility/generators/solids.h"

namespace vismat {
namespace {

using glm::dvec3;
using Triangles = std::vector<std::array<std::uint32_t, 3>>;

Mesh mesh_of_object(const Scene& scene, std::uint32_t object) {
  std::vector<std::uint32_t> triangles;
  for (std::uint32_t t = 0; t < scene.object_of_triangle.size(); ++t) {
    if (scene.object_of_triangle[t] == object) triangles.push_back(t);
  }
  return mesh_of(scene.vertices, scene.indices, triangles);
}

dvec3 nearest_on_triangle(const dvec3& p, const dvec3& a, const dvec3& b, const dvec3& c) {
  const dvec3 n = glm::cross(b - a, c - a);
  if (glm::dot(n, n) > 0) {
    const dvec3 q = p - n * (glm::dot(p - a, n) / glm::dot(n, n));
    if (glm::dot(glm::cross(b - a, q - a), n) >= 0 && glm::dot(glm::cross(c - b, q - b), n) >= 0 &&
        glm::dot(glm::cross(a - c, q - c), n) >= 0) {
      return q;
    }
  }
  dvec3 best = a;
  for (const auto& [from, to] : {std::array{a, b}, std::array{b, c}, std::array{c, a}}) {
    const dvec3 d = to - from;
    const double t = glm::dot(d, d) > 0 ? std::clamp(glm::dot(p - from, d) / glm::dot(d, d), 0.0, 1.0) : 0;
    if (glm::distance(p, from + d * t) < glm::distance(p, best)) best = from + d * t;
  }
  return best;
}

dvec3 nearest(const dvec3& p, const Mesh& mesh, const Triangles& triangles) {
  dvec3 best(std::numeric_limits<double>::infinity());
  for (const auto& [a, b, c] : triangles) {
    const dvec3 q = nearest_on_triangle(p, mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]);
    if (!(glm::distance(p, q) >= glm::distance(p, best))) best = q;
  }
  return best;
}

dvec3 sample(Random& random, const Mesh& mesh, const Triangles& triangles) {
  const auto& [a, b, c] = triangles[random.below(static_cast<std::uint32_t>(triangles.size()))];
  double s = random.fraction(), t = random.fraction();
  if (random.below(4) == 0) t = 0;  // on sides too
  if (s + t > 1) s = 1 - s, t = 1 - t;
  return mesh.vertices[a] + s * (mesh.vertices[b] - mesh.vertices[a]) +
         t * (mesh.vertices[c] - mesh.vertices[a]);
}

/// The greatest distance found from a sampled point of either surface to the other.
double sampled_hausdorff(const Mesh& mesh, const Triangles& one, const Triangles& other, unsigned samples) {
  Random random(5);
  double worst = 0;
  for (unsigned i = 0; i < samples; ++i) {
    const dvec3 p = sample(random, mesh, one), q = sample(random, mesh, other);
    worst =
        std::max({worst, glm::distance(p, nearest(p, mesh, other)), glm::distance(q, nearest(q, mesh, one))});
  }
  return worst;
}

Scene ball(unsigned sides, float roughness, std::uint64_t seed) {
  Scene scene;
  Random random(seed);
  std::vector<std::vector<glm::vec3>> rings;
  for (unsigned r = 1; r < sides; ++r) {
    const float angle = 3.1415927f * static_cast<float>(r) / static_cast<float>(sides);
    rings.push_back(circle({0, 0, -std::cos(angle)}, {0, 0, 1}, std::sin(angle), 2 * sides));
    for (glm::vec3& p : rings.back()) p *= 1 + random.between(-roughness, roughness);
  }
  add_loft(scene, {0, 0, -1}, rings, {0, 0, 1});
  scene.object_count = 1;
  return scene;
}

Scene open_wave() {
  Scene scene;
  add_ground(scene, 8, 0.5f);
  for (glm::vec3& v : scene.vertices) v.z = 0.3f * std::sin(v.x * 1.3f) * std::cos(v.y);
  scene.object_count = 1;
  return scene;
}

TEST(LevelsOfDetail, StayWithinTheirErrorBothWays) {
  const Scene city =
      make_dense_city({.size = 2, .interiors = 0.5f, .car_parks = 0.3f, .car_sides = 12}).scene;
  std::vector<Mesh> meshes = {mesh_of_object(ball(10, 0, 1), 0), mesh_of_object(ball(8, 0.2f, 2), 0),
                              mesh_of_object(open_wave(), 0)};
  for (std::uint32_t object = 0; object < city.object_count && meshes.size() < 12; object += 7) {
    meshes.push_back(mesh_of_object(city, object));
  }
  double closest = 0;  // how much of the bound is used
  for (const Mesh& mesh : meshes) {
    const std::vector<LevelOfDetail> levels = levels_of_detail(mesh);
    for (std::size_t i = 1; i < levels.size(); ++i) {
      EXPECT_LE(levels[i].triangles.size() * 4, levels[i - 1].triangles.size() * 3);
      EXPECT_GE(levels[i].error, levels[i - 1].error);
      const double found = sampled_hausdorff(mesh, mesh.triangles, levels[i].triangles, 100);
      EXPECT_LE(found, levels[i].error + 1e-12);
      if (levels[i].error > 1e-3) closest = std::max(closest, found / levels[i].error);
    }
  }
  EXPECT_GT(closest, 0.2);  // a bound that is never near says little
}

TEST(LevelsOfDetail, AFlatWallIsFewTrianglesWithoutError) {
  Scene scene;
  add_box(scene, {{0, 0, 0}, {12, 12, 12}}, 1);
  scene.object_count = 1;
  const std::vector<LevelOfDetail> levels = levels_of_detail(mesh_of_object(scene, 0));
  const auto last_flat =
      std::find_if(levels.begin(), levels.end(), [](const auto& l) { return l.error > 0.01; });
  ASSERT_NE(last_flat, levels.begin());
  EXPECT_LE((last_flat - 1)->triangles.size(), 1728u / 32);
}

TEST(LevelsOfDetail, BoundariesDriftNoFarther) {
  const Mesh mesh = mesh_of_object(open_wave(), 0);
  const auto boundary = [&](const Triangles& triangles) {  // as needles, so that nearest() serves
    Triangles needles;
    const std::vector<MeshSide> sides = sides_of({mesh.vertices, triangles});
    for (std::size_t i = 0; i < sides.size(); ++i) {
      const bool shared = (i > 0 && sides[i - 1].ends == sides[i].ends) ||
                          (i + 1 < sides.size() && sides[i + 1].ends == sides[i].ends);
      if (!shared) needles.push_back({sides[i].ends[0], sides[i].ends[1], sides[i].ends[1]});
    }
    return needles;
  };
  const std::vector<LevelOfDetail> levels = levels_of_detail(mesh);
  ASSERT_GE(levels.size(), 4u);
  for (const LevelOfDetail& level : levels) {
    EXPECT_LE(sampled_hausdorff(mesh, boundary(mesh.triangles), boundary(level.triangles), 100),
              level.error + 1e-12);
  }
}

TEST(LevelsOfDetail, NonManifoldAndSoupAreKeptOrParted) {
  Scene scene;  // two boxes that share an edge, and a fin on it
  add_box(scene, {{0, 0, 0}, {1, 1, 1}}, 0.25f);
  add_box(scene, {{1, 1, 0}, {2, 2, 1}}, 0.25f);
  const auto base = static_cast<std::uint32_t>(scene.vertices.size());
  scene.vertices.insert(scene.vertices.end(), {{1, 1, 0}, {1, 1, 0.25f}, {3, 0, 0}});
  scene.indices.insert(scene.indices.end(), {base, base + 1, base + 2});
  scene.object_of_triangle.push_back(0);
  scene.object_count = 1;
  const Mesh mesh = mesh_of_object(scene, 0);
  for (const LevelOfDetail& level : levels_of_detail(mesh)) {
    EXPECT_LE(sampled_hausdorff(mesh, mesh.triangles, level.triangles, 100), level.error + 1e-12);
  }
  Scene soup;
  Random random(3);
  for (std::uint32_t i = 0; i < 300; ++i) {
    soup.vertices.emplace_back(random.unit(), random.unit(), random.unit());
    soup.indices.push_back(i);
    if (i % 3 == 0) soup.object_of_triangle.push_back(0);
  }
  soup.object_count = 1;
  EXPECT_EQ(levels_of_detail(mesh_of_object(soup, 0)).size(), 1u);
  EXPECT_EQ(levels_of_detail({}).size(), 1u);
}

Box random_box(Random& random, float reach, float most) {
  Box box;
  for (unsigned axis = 0; axis < 3; ++axis) {
    box.low[axis] = random.between(-reach, reach);
    box.high[axis] = box.low[axis] + (random.below(4) == 0 ? 0 : random.between(0, most));
  }
  return box;
}

/// The failure case: a level that pops by a pixel or more. Sampled points of the level chosen and of the original must each
/// have a point of the other within a pixel, from viewpoints all over the cell; one level coarser would show.
TEST(LevelsOfDetail, NoPointMovesAPixel) {
  const Screen screen{640, 480, 60};
  const double per_radian = pixels_per_radian(screen);
  const Scene scene = ball(12, 0.05f, 1);
  const LevelsOfDetail all(scene, screen, 1);
  const Mesh& mesh = all.mesh(0);
  Random random(2);
  double worst_coarser = 0;
  unsigned coarse = 0;
  for (unsigned round = 0; round < 40; ++round) {
    const Box cell = random_box(random, 60, 4);
    const std::uint32_t level = all.level_for(cell, 0);
    coarse += level > 0 ? 1 : 0;
    const auto worst = [&](std::uint32_t which) {
      const Triangles& triangles = all.levels(0)[which].triangles;
      double pixels = 0;
      for (unsigned i = 0; i < 30; ++i) {
        dvec3 eye;
        for (int axis = 0; axis < 3; ++axis) {
          eye[axis] = cell.low[axis] + random.fraction() * (cell.high[axis] - cell.low[axis]);
        }
        for (const bool forth : {true, false}) {
          const dvec3 p = sample(random, mesh, forth ? mesh.triangles : triangles);
          const dvec3 q = nearest(p, mesh, forth ? triangles : mesh.triangles);
          const dvec3 a = glm::normalize(p - eye), b = glm::normalize(q - eye);
          pixels = std::max(pixels, std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)) * per_radian);
        }
      }
      return pixels;
    };
    EXPECT_LT(worst(level), 1);
    if (level + 2 < all.levels(0).size()) worst_coarser = std::max(worst_coarser, worst(level + 2));
  }
  EXPECT_GT(coarse, 10u);
  EXPECT_GT(worst_coarser, 1);
}

TEST(LevelsOfDetail, DeviationIsWhatTheCornerOfThePictureShows) {
  EXPECT_NEAR(pixels_per_radian({1000, 0 + 1, 90}), 1000, 0.01);  // 500 in the middle, twice at 45 degrees
  const Box cell = {{0, 0, 0}, {1, 1, 1}}, object = {{11, 0, 0}, {12, 1, 1}};
  EXPECT_NEAR(deviation_in_pixels(0.01, cell, object, 1000), 1, 1e-6);
  EXPECT_EQ(deviation_in_pixels(0.01, cell, cell, 1000), std::numeric_limits<double>::infinity());
  EXPECT_EQ(deviation_in_pixels(0, cell, cell, 1000), 0);
  EXPECT_THROW(pixels_per_radian({0, 1, 90}), std::invalid_argument);
  EXPECT_THROW(pixels_per_radian({1, 1, 180}), std::invalid_argument);
}

/// All triangles against all corners of the cell, one by one.
std::uint64_t facing_by_corners(const Mesh& mesh, const Triangles& triangles, const Box& cell) {
  std::uint64_t facing = 0;
  for (const auto& [a, b, c] : triangles) {
    const dvec3 at = mesh.vertices[a], n = glm::cross(mesh.vertices[b] - at, mesh.vertices[c] - at);
    bool faces = false;
    for (unsigned corner = 0; corner < 8; ++corner) {
      const dvec3 w(corner & 1 ? cell.high[0] : cell.low[0], corner & 2 ? cell.high[1] : cell.low[1],
                    corner & 4 ? cell.high[2] : cell.low[2]);
      faces = faces || glm::dot(n, w - at) >= 0;
    }
    facing += faces ? 1 : 0;
  }
  return facing;
}

TEST(BackFaces, CountWhatTheCornersOfTheCellTell) {
  const Scene city =
      make_dense_city({.size = 2, .interiors = 0.5f, .car_parks = 0.3f, .car_sides = 12}).scene;
  Random random(7);
  std::uint64_t culled = 0;
  for (std::uint32_t object = 0; object < city.object_count; object += 3) {
    const Mesh mesh = mesh_of_object(city, object);
    EXPECT_EQ(is_closed_outward(mesh), object != 0);  // the ground is a sheet
    const BackFaces faces(mesh.vertices, mesh.triangles);
    for (unsigned round = 0; round < 10; ++round) {
      Box cell = random_box(random, 40, 10);
      if (round == 0) cell = {{12, 3, 1.5f}, {12, 3, 1.5f}};  // a point
      const std::uint64_t facing = faces.facing(cell);
      EXPECT_EQ(facing, facing_by_corners(mesh, mesh.triangles, cell)) << "object " << object;
      culled += mesh.triangles.size() - facing;
    }
  }
  EXPECT_GT(culled, 1000u);
}

TEST(BackFaces, NeedAClosedOutwardSurface) {
  Scene scene = ball(6, 0, 1);
  EXPECT_TRUE(is_closed_outward(mesh_of_object(scene, 0)));
  for (std::size_t t = 0; t < scene.indices.size(); t += 3) std::swap(scene.indices[t], scene.indices[t + 1]);
  EXPECT_FALSE(is_closed_outward(mesh_of_object(scene, 0)));  // inside out
  scene = ball(6, 0, 1);
  std::swap(scene.indices[0], scene.indices[1]);
  EXPECT_FALSE(is_closed_outward(mesh_of_object(scene, 0)));
  EXPECT_FALSE(is_closed_outward({}));
}

TEST(LevelsOfDetail, TrianglesOfAVlodAreFewerThanThoseOfItsObjects) {
  const SceneFile city =
      make_dense_city({.size = test::sanitized ? 1u : 2u, .interiors = 0, .car_sides = 12});
  const LevelsOfDetail one(city.scene, {}, 1), two(city.scene, {}, 2);
  std::vector<std::uint32_t> objects(city.scene.object_count);
  std::iota(objects.begin(), objects.end(), 0);
  for (const Box& cell : {city.cells.boxes.front(), city.cells.boxes.back()}) {
    const std::uint64_t triangles = one.visible_triangles(cell, objects);
    EXPECT_EQ(triangles, two.visible_triangles(cell, objects));
    EXPECT_GT(triangles, 100u);
    EXPECT_LT(triangles, city.scene.object_of_triangle.size() / 2);
  }
  EXPECT_EQ(one.visible_triangles(city.cells.boxes.front(), {}), 0u);
}

}  // namespace
}  // namespace vismat
