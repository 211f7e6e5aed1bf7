#include "visibility/producers/see_levels.h"

#include <set>

#include "matrix/base/random.h"
#include "visibility/detail/scenes_at_levels.h"
#include "visibility/generators/dense_city.h"
#include "visibility/geometry/cell_points.h"
#include "visibility/rays/ray_caster.h"

namespace vismat {
namespace {

/// Some cells of a city whose cars have several levels.
SceneFile some_city() {
  SceneFile city = make_dense_city({.size = 3, .car_parks = .5f, .car_sides = 12});
  ViewCells some;
  for (std::size_t i = 0; i < city.cells.boxes.size(); i += 12) some.boxes.push_back(city.cells.boxes[i]);
  city.cells = some;
  return city;
}

LevelSight see(const SceneFile& file, const LevelsOfDetail& levels, const BoundsOptions& options,
               unsigned threads = 2) {
  ThreadJobRunner runner(threads);
  return see_levels(file.scene, levels, file.cells, options, runner);
}

BoundsOptions sandwich() {
  BoundsOptions options = effort(1);
  options.shadow.patches = 12;
  options.sampled->rays = 500;
  return options;
}

TEST(SeeLevels, ListsWhateverARayReachesOverTheSceneAtTheCellsLevels) {
  const SceneFile city = some_city();
  for (const std::uint32_t width : {64u, 640u}) {  // the fewer pixels, the coarser
    const LevelsOfDetail levels(city.scene, {width, width / 2, 90});
    for (const BoundsOptions& options : {effort(0), sandwich()}) {
      const LevelSight sight = see(city, levels, options);
      std::uint64_t reached = 0, coarse = 0;
      for (std::uint32_t cell = 0; cell < city.cells.count(); ++cell) {
        const std::vector<std::uint32_t> level_of_object = levels.levels_for(city.cells.boxes[cell]);
        std::set<std::pair<std::uint32_t, std::uint32_t>> listed;
        for (const std::uint32_t column : sight.sight.not_hidden.row(cell)) {
          const auto [object, level] = sight.columns[column];
          EXPECT_EQ(level, level_of_object[object]);
          listed.emplace(object, level);
        }
        const Scene scene = scene_at(city.scene, levels, level_of_object);
        const RayCaster caster(scene);
        const CellPoints points(convex_of(city.cells, cell));
        Random random(5, cell);
        for (unsigned ray = 0; ray < 3000; ++ray) {
          const glm::vec3 from = points.on_face(random);
          const glm::vec3 direction(random.between(-1, 1), random.between(-1, 1), random.between(-.3f, .3f));
          const Hit hit = caster.hit(from, direction);
          if (hit.triangle == Hit::nothing) continue;
          const std::uint32_t object = scene.object_of_triangle[hit.triangle];
          ASSERT_TRUE(listed.contains({object, level_of_object[object]}))
              << "object " << object << " from cell " << cell;
          ++reached;
          coarse += level_of_object[object] > 0;
        }
      }
      EXPECT_GT(reached, 10000u);
      EXPECT_TRUE(width != 64 || coarse > 100) << coarse;
    }
  }
}

TEST(SeeLevels, IsTheVisibilityOfTheSceneWhereNoLevelMayBeCoarser) {
  const SceneFile city = some_city();
  const LevelsOfDetail levels(city.scene, {100'000'000, 100'000'000, 90});
  const LevelSight sight = see(city, levels, effort(0));
  ThreadJobRunner runner(2);
  const Sight full = see_bounds(city.scene, city.cells, effort(0), runner);
  for (std::uint32_t cell = 0; cell < city.cells.count(); ++cell) {
    std::vector<std::uint32_t> at_levels, facing;
    for (const std::uint32_t column : sight.sight.not_hidden.row(cell)) {
      EXPECT_EQ(sight.columns[column].level, 0u);
      at_levels.push_back(sight.columns[column].object);
    }
    for (const std::uint32_t object : full.not_hidden.row(cell)) {
      if (levels.facing_triangles(city.cells.boxes[cell], object, 0) > 0) facing.push_back(object);
    }
    EXPECT_EQ(at_levels, facing) << "cell " << cell;
  }
}

TEST(SeeLevels, IsTheSameForAnyNumberOfThreads) {
  const SceneFile city = some_city();
  const LevelsOfDetail levels(city.scene, {64, 64, 90});
  const LevelSight one = see(city, levels, sandwich(), 1);
  for (const unsigned threads : {2u, 8u}) {
    const LevelSight more = see(city, levels, sandwich(), threads);
    EXPECT_EQ(more.columns, one.columns);
    EXPECT_EQ(more.column_bounds, one.column_bounds);
    EXPECT_EQ(more.sight, one.sight);
  }
  EXPECT_EQ(one.columns.size(), one.sight.not_hidden.shape().columns);
  EXPECT_TRUE(
      std::is_sorted(one.columns.begin(), one.columns.end(), [](const ObjectLevel& a, const ObjectLevel& b) {
        return std::pair(a.object, a.level) < std::pair(b.object, b.level);
      }));
}

}  // namespace
}  // namespace vismat
