// Tests bounds by shadows and rays.
#include "visibility/producers/bounds.h"

#include <gtest/gtest.h>

#include <glm/geometric.hpp>

#include "matrix/loss.h"
#include "tests/sanitized.h"
#include "visibility/generators/city.h"
#include "visibility/geometry/cell_points.h"
#include "visibility/rays/ray_caster.h"

namespace vismat {
namespace {

/// A small city: prisms over its ground as view cells, and a few boxes between its buildings.
SceneFile small_city_file(std::uint32_t size = 8) {
  CityOptions options;
  options.size = size;
  options.eye_low = 1, options.eye_high = 2;
  SceneFile city = make_city(options);
  city.cells.corners.resize(3 * std::size_t{test::sanitized ? 2 : 6});
  city.cells.neighbours.reset();
  for (std::uint32_t i = test::sanitized ? 5 : 3; i < 6; ++i) {
    const float at = static_cast<float>(i) * options.pitch;
    city.cells.boxes.push_back({{at - 1.5f, at - 1.5f, 1}, {at + 1.5f, at + 1.5f, i % 2 ? 2.5f : 1}});
  }
  return city;
}

bool within(const VisibilityMatrix& inner, const VisibilityMatrix& outer) {
  return loss_of(outer, inner).missing == 0;
}

TEST(Bounds, BoundsLieInOneAnotherAndRaysLieBetween) {
  const SceneFile city = small_city_file();
  ThreadJobRunner runner;
  const Sight quick = see_bounds(city.scene, city.cells, effort(0), runner),
              better = see_bounds(city.scene, city.cells, effort(1), runner);
  EXPECT_EQ(quick.seen.ones(), 0u);
  EXPECT_TRUE(within(better.not_hidden, quick.not_hidden));
  EXPECT_TRUE(within(better.seen, better.not_hidden));
  EXPECT_LT(better.not_hidden.ones(), quick.not_hidden.ones());
  EXPECT_GT(better.seen.ones() * 10, better.not_hidden.ones() * 6);
  EXPECT_LT(better.not_hidden.density(), 0.95);
}

TEST(Bounds, EverySightLineIsASightLine) {
  const SceneFile city = small_city_file();
  ThreadJobRunner runner;
  const Sight sight = see_bounds(city.scene, city.cells, effort(1), runner);
  ASSERT_EQ(sight.lines.size(), sight.seen.ones());
  const RayCaster caster(city.scene);
  std::size_t entry = 0;
  for (std::uint32_t cell = 0; cell < city.cells.count(); ++cell) {
    const CellPoints points(convex_of(city.cells, cell));
    for (const std::uint32_t object : sight.seen.row(cell)) {
      const SightLine& line = sight.lines[entry++];
      EXPECT_TRUE(points.contains(line.from));
      if (line.from == line.to) continue;  // the object touches the cell
      const Hit hit = caster.hit(line.from, line.to - line.from);
      ASSERT_NE(hit.triangle, Hit::nothing);
      EXPECT_EQ(city.scene.object_of_triangle[hit.triangle], object);
      EXPECT_NEAR(hit.distance, 1, 1e-3);
    }
  }
}

TEST(Bounds, IsTheSameForAnyNumberOfThreads) {
  SceneFile city = small_city_file();
  if (test::sanitized) city.cells.boxes.resize(1), city.cells.corners.resize(3);
  ThreadJobRunner one(1), three(3);
  const Sight a = see_bounds(city.scene, city.cells, effort(1), one),
              b = see_bounds(city.scene, city.cells, effort(1), three);
  EXPECT_EQ(a.seen, b.seen);
  EXPECT_EQ(a.not_hidden, b.not_hidden);
  EXPECT_EQ(a.lines, b.lines);
  EXPECT_EQ(a.rays, b.rays);
}

TEST(Bounds, ASmallerCellSeesLess) {
  SceneFile city = small_city_file(4);
  city.cells.corners.clear();
  const float at = 2 * 20;
  city.cells.boxes = {{{at - 1.5f, at - 1.5f, 1}, {at + 1.5f, at + 1.5f, 2.5f}},
                      {{at - 0.5f, at - 0.5f, 1.5f}, {at + 0.5f, at + 0.5f, 2}},
                      {{at, at, 2}, {at, at, 2}}};
  ThreadJobRunner runner;
  const Sight sight = see_bounds(city.scene, city.cells, effort(2), runner);
  EXPECT_GE(sight.not_hidden.row(0).size(), sight.not_hidden.row(1).size());
  EXPECT_GE(sight.not_hidden.row(1).size(), sight.not_hidden.row(2).size());
}

TEST(Bounds, EmptyScenesAndNoCellsAreFine) {
  ThreadJobRunner runner;
  ViewCells one;
  one.boxes = {{{0, 0, 0}, {1, 1, 1}}};
  EXPECT_EQ(see_bounds(Scene{}, one, effort(1), runner).not_hidden.shape(), (Shape{1, 0}));
  EXPECT_EQ(see_bounds(small_city_file().scene, {}, effort(1), runner).not_hidden.shape(), (Shape{0, 64}));
  EXPECT_THROW(effort(3), std::invalid_argument);
}

}  // namespace
}  // namespace vismat
