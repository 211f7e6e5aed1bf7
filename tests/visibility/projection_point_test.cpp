#include "visibility/shadows/projection_point.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <glm/geometric.hpp>

#include "matrix/base/random.h"
#include "visibility/shadows/shadow.h"

namespace vismat {
namespace {

using glm::dvec3;

Occluder wall(double y, double half_width, double half_height) {
  const std::vector<dvec3> corners = {{-half_width, y, -half_height},
                                      {half_width, y, -half_height},
                                      {half_width, y, half_height},
                                      {-half_width, y, half_height}};
  Occluder occluder;
  occluder.shape = convex_polygon(corners, {0, -1, 0});
  occluder.flat = true;
  return occluder;
}

std::optional<Shrinkage> shrinkage_of(const Convex& cell, const Occluder& occluder) {
  std::vector<Plane> planes;
  supporting_planes(cell, occluder.shape, occluder.flat, planes);
  return shrinkage(cell, occluder, planes);
}

TEST(ProjectionPoint, ApexOfAWall) {
  // Half width 6 at distance 8 from a flat cell of half width 2: lines through the edges meet at distance 12.
  const Convex cell = convex_box({{-2, 0, -1}, {2, 0, 1}});
  const auto found = shrinkage_of(cell, wall(8, 6, 2));
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->normal.y, -1, 1e-12);
  EXPECT_NEAR(found->plane, -8, 1e-12);
  EXPECT_NEAR(found->apex, 12 - 8, 1e-9);
  EXPECT_FALSE(shrinkage_of(cell, wall(8, 1.9, 2))) << "narrower than the cell";
  EXPECT_GT(found->weight, shrinkage_of(cell, wall(8, 6, 1.8))->weight);
}

TEST(ProjectionPoint, NoOtherPointOfTheCellIsBetter) {
  Random random(7);
  for (const Convex& cell : {convex_box({{-2, -2, 1}, {2, 2, 2.5f}}), convex_box({{-2, -2, 1}, {2, 2, 1}}),
                             convex_prism({glm::vec3{-2, -2, 0}, {2, -2, 1}, {0, 2, 0}}, 1.6f, 1.6f)}) {
    std::vector<Shrinkage> occluders;
    for (int i = 0; i < 60; ++i) {
      const float x = random.between(5, 60) * (random.below(2) ? 1 : -1), y = random.between(-60, 60);
      const float side = random.between(6, 15);
      Occluder box;
      box.shape = convex_box({{x, y, -100}, {x + (x > 0 ? side : -1), y + side, random.between(6, 30)}});
      if (x < 0) box.shape = convex_box({{x - side, y, -100}, {x, y + side, random.between(6, 30)}});
      if (const auto found = shrinkage_of(cell, box)) occluders.push_back(*found);
    }
    ASSERT_GT(occluders.size(), 10u);
    const auto apexes = ProjectionObjective::apexes, areas = ProjectionObjective::areas;
    const dvec3 nearest = projection_point(cell, occluders, apexes),
                largest = projection_point(cell, occluders, areas);
    for (const dvec3& point : {nearest, largest}) {
      for (const Convex::Face& face : cell.faces) EXPECT_LE(glm::dot(face.normal, point), face.offset + 1e-9);
    }
    for (int i = 0; i < 1000; ++i) {
      dvec3 point{};
      double total = 0;
      for (const dvec3& vertex : cell.vertices) {
        const double weight = random.fraction();
        point += weight * vertex, total += weight;
      }
      point /= total;
      EXPECT_LE(value_of(nearest, occluders, apexes), value_of(point, occluders, apexes) * (1 + 1e-6));
      EXPECT_GE(value_of(largest, occluders, areas), value_of(point, occluders, areas));
    }
  }
}

TEST(ProjectionPoint, NothingToChooseByGivesTheCentre) {
  for (const auto objective : {ProjectionObjective::apexes, ProjectionObjective::areas}) {
    EXPECT_EQ(projection_point(convex_box({{0, 0, 0}, {4, 2, 2}}), {}, objective), dvec3(2, 1, 1));
    EXPECT_EQ(projection_point(convex_box({{1, 1, 1}, {1, 1, 1}}), {}, objective), dvec3(1, 1, 1));
  }
}

}  // namespace
}  // namespace vismat
