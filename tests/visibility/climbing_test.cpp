// The producer "climbing" against plain rays and scenes whose answer is known.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "matrix/base/random.h"
#include "tests/visibility/open_boxes.h"
#include "visibility/generators/city.h"
#include "visibility/producers/producers.h"
#include "visibility/rays/ray_caster.h"

namespace vismat {
namespace {

using Ids = std::vector<std::uint32_t>;

/// A small cell about (x, y).
void add_cell(ViewCells& cells, float x, float y) {
  cells.corners.insert(cells.corners.end(), {{x - 1, y - 1, 0}, {x + 1, y - 1, 0}, {x, y + 1, 0}});
}

Sight climb(const Scene& scene, const ViewCells& cells, const ProducerOptions& options = {},
            unsigned threads = 0) {
  ThreadJobRunner runner(threads);
  return producer_named("climbing").see(scene, cells, options, runner, {});
}

Ids row(const VisibilityMatrix& matrix, std::uint32_t r) {
  return {matrix.row(r).begin(), matrix.row(r).end()};
}

TEST(Climbing, WallHidesWhatIsBehindIt) {
  Scene scene;
  add_open_box(scene, {{-100, 10, 0}, {100, 11, 10}});  // 0: the wall
  add_open_box(scene, {{-5, -20, 0}, {5, -15, 5}});     // 1: in the open
  add_open_box(scene, {{-5, 20, 0}, {5, 25, 5}});       // 2: behind the wall
  ViewCells cells;
  add_cell(cells, 0, 0);
  EXPECT_EQ(row(climb(scene, cells).seen, 0), (Ids{0, 1}));
}

TEST(Climbing, TwoSidesOfAWall) {
  Scene scene;
  add_open_box(scene, {{-1000, -1, 0}, {1000, 1, 10}});
  add_open_box(scene, {{-5, -20, 0}, {5, -15, 5}});
  add_open_box(scene, {{-5, 20, 0}, {5, 25, 5}});
  ViewCells cells;
  add_cell(cells, 0, -8);
  add_cell(cells, 0, 8);
  const Sight seen = climb(scene, cells);
  EXPECT_EQ(seen.seen, VisibilityMatrix::from_rows({{0, 1}, {0, 2}}, 3));
  EXPECT_TRUE(seen.last_found);
  EXPECT_GT(seen.rays, 0u);
}

TEST(Climbing, TowersRiseOverRoofs) {
  Scene scene;
  add_open_box(scene, {{-100, 10, 0}, {100, 12, 4}});  // 0: a low wall
  add_open_box(scene, {{-5, 30, 0}, {5, 40, 3}});      // 1: lower still
  add_open_box(
      scene, {{-5, 100, 0}, {5, 110, 40}});  // 2: a tower: eyes at 1.6 m and the wall leave 26 m hidden there
  add_open_box(scene, {{-5, 200, 0}, {5, 210, 60}});   // 3: hidden by the tower's 38 m at twice the distance
  add_open_box(scene, {{40, 200, 0}, {50, 210, 60}});  // 4: beside the tower
  ViewCells cells;
  add_cell(cells, 0, 0);
  EXPECT_EQ(row(climb(scene, cells).seen, 0), (Ids{0, 2, 4}));
}

TEST(Climbing, FindsWhatANarrowGapShows) {
  Scene scene;
  add_open_box(scene, {{-100, 20, 0}, {-0.01f, 21, 50}});
  add_open_box(scene, {{0.01f, 20, 0}, {100, 21, 50}});
  add_open_box(scene, {{-10, 100, 0}, {10, 110, 20}});
  ViewCells cells;
  add_cell(cells, 0, 0);
  EXPECT_EQ(row(climb(scene, cells).seen, 0), (Ids{0, 1, 2}));
}

TEST(Climbing, GlassIsSeenAndSeenThrough) {
  Scene scene;
  add_open_box(scene, {{-100, 10, 0}, {100, 11, 50}});  // 0: a pane
  add_open_box(scene, {{-5, 20, 0}, {5, 25, 5}});       // 1: behind it
  add_open_box(scene, {{-5, 40, 0}, {5, 45, 35}});      // 2: over that, before the sky
  add_open_box(scene, {{-4, 30, 0}, {4, 31, 2}});       // 3: behind 1
  scene.see_through = {1, 0, 1, 0};
  ViewCells cells;
  add_cell(cells, 0, 0);
  EXPECT_EQ(row(climb(scene, cells).seen, 0), (Ids{0, 1, 2}));
}

TEST(RayCaster, PassesWhatIsSeeThrough) {
  Scene scene;
  for (const float y : {0.f, 10.f, 20.f, 30.f, 40.f, 50.f}) add_open_box(scene, {{0, y, 0}, {9, y + 1, 9}});
  scene.see_through = {1, 1, 0, 1, 0, 1};
  const RayCaster caster(scene);
  EXPECT_TRUE(caster.any_see_through());
  const glm::vec3 from(3.3f, -10, 2), along(0, 2, 0.1f);
  const auto object = [&](std::uint32_t triangle) { return scene.object_of_triangle[triangle]; };
  const Hit hit = caster.hit(from, along);
  ASSERT_NE(hit.triangle, Hit::nothing);
  EXPECT_EQ(object(hit.triangle), 2u);
  EXPECT_FLOAT_EQ(hit.distance, 15);
  const auto passed_objects = [&](float distance) {
    Ids objects;
    for (const std::uint32_t triangle : caster.passed(from, along, distance))
      objects.push_back(object(triangle));
    return objects;
  };
  EXPECT_EQ(passed_objects(hit.distance), (Ids{0, 0, 1, 1}));
  EXPECT_EQ(passed_objects(5.2f), (Ids{0}));
  EXPECT_EQ(passed_objects(std::numeric_limits<float>::infinity()), (Ids{0, 0, 1, 1, 3, 3, 5, 5}));
  EXPECT_EQ(caster.hit({4, 42, 2}, {0, 1, 0}).triangle, Hit::nothing) << "what is left is glass";
  scene.see_through.assign(6, 0);
  const RayCaster opaque(scene);
  EXPECT_FALSE(opaque.any_see_through());
  EXPECT_EQ(object(opaque.hit(from, along).triangle), 0u);
  EXPECT_TRUE(opaque.passed(from, along, 1000).empty());
}

TEST(Climbing, EyesBetweenTwoHeightsSeeFromBoth) {
  Scene scene;
  add_open_box(scene, {{-100, 10, 0}, {100, 11, 5}});
  add_open_box(scene, {{-5, 20, 0}, {5, 25, 4}});
  ViewCells cells;
  add_cell(cells, 0, 0);
  EXPECT_EQ(row(climb(scene, cells).seen, 0), (Ids{0}));
  cells.eye_high = 20;
  EXPECT_EQ(row(climb(scene, cells).seen, 0), (Ids{0, 1})) << "over the wall, down to the roof";
}

/// A slow, obvious judge: rays in all directions, tested against every box.
Ids seen_by_plain_rays(const std::vector<Box>& boxes, const ViewCells& cells, std::uint32_t cell,
                       unsigned rays) {
  Random random(5, cell);
  std::vector<bool> seen(boxes.size(), false);
  const glm::vec3* corner = &cells.corners[std::size_t{3} * cell];
  for (unsigned i = 0; i < rays; ++i) {
    float u = random.unit(), v = random.unit();
    if (u + v > 1) u = 1 - u, v = 1 - v;
    glm::vec3 origin = corner[0] + (corner[1] - corner[0]) * u + (corner[2] - corner[0]) * v;
    origin.z += cells.eye_low;
    const float angle = random.between(0, 6.2831853f), slope = random.unit();
    const glm::vec3 direction(std::cos(angle), std::sin(angle), slope * slope * 0.7f);
    float nearest = std::numeric_limits<float>::infinity();
    std::size_t hit = boxes.size();
    for (std::size_t b = 0; b < boxes.size(); ++b) {
      float in = 0, out = nearest;
      for (int axis = 0; axis < 3; ++axis) {
        const float low = (boxes[b].low[axis] - origin[axis]) / direction[axis];
        const float high = (boxes[b].high[axis] - origin[axis]) / direction[axis];
        in = std::max(in, std::min(low, high));
        out = std::min(out, std::max(low, high));
      }
      if (in < out) nearest = in, hit = b;
    }
    if (hit < boxes.size()) seen[hit] = true;
  }
  Ids ids;
  for (std::uint32_t b = 0; b < boxes.size(); ++b) {
    if (seen[b]) ids.push_back(b);
  }
  return ids;
}

TEST(Climbing, FindsWhatPlainRaysFind) {
  CityOptions options;
  options.size = 8;
  const SceneFile city = make_city(options);
  const std::vector<Box> boxes = object_bounds(city.scene);
  const VisibilityMatrix objects = climb(city.scene, city.cells).seen;
  std::size_t reference = 0, missed = 0;
  for (std::uint32_t cell = 0; cell < city.cells.count(); cell += 37) {
    for (const std::uint32_t object : seen_by_plain_rays(boxes, city.cells, cell, 20000)) {
      ++reference;
      missed += !objects.contains(cell, object);
    }
  }
  EXPECT_GT(reference, 150u);
  EXPECT_LE(missed * 200, reference) << missed << " of " << reference;
}

TEST(Climbing, MonotoneOverTheTree) {
  CityOptions options;
  options.size = 8;
  const SceneFile city = make_city(options);
  const VisibilityMatrix nodes = nodes_from_objects(climb(city.scene, city.cells).seen, *city.tree);
  EXPECT_TRUE(is_monotone(nodes, *city.tree));
  for (std::uint32_t cell = 0; cell < nodes.shape().rows; ++cell) EXPECT_TRUE(nodes.contains(cell, 0));
}

TEST(Climbing, SameForAnyNumberOfThreadsAndAnotherForAnotherSeed) {
  CityOptions small;
  small.size = 8;
  const SceneFile city = make_city(small);
  ProducerOptions options;
  options.passes = 2;
  options.viewpoints = 1;
  options.directions = 16;
  const Sight one = climb(city.scene, city.cells, options, 1);
  EXPECT_EQ(climb(city.scene, city.cells, options, 2), one);
  options.seed = 2;
  EXPECT_NE(climb(city.scene, city.cells, options).seen, one.seen);
}

TEST(Climbing, NothingToSeeAndNobodyToSeeIt) {
  Scene scene;
  ViewCells cells;
  EXPECT_EQ(climb(scene, cells).seen.shape(), (Shape{0, 0}));
  add_cell(cells, 0, 0);
  EXPECT_EQ(climb(scene, cells).seen, VisibilityMatrix(Shape{1, 0}));
  add_open_box(scene, {{10, 10, 0}, {20, 20, 5}});
  scene.object_count = 2;  // the second without triangles
  EXPECT_EQ(row(climb(scene, cells).seen, 0), Ids{0});
  EXPECT_EQ(climb(scene, {}).seen.shape(), (Shape{0, 2}));
}

TEST(Climbing, OddCellsAndObjects) {
  Scene scene;
  add_open_box(scene, {{-10, -10, 0}, {10, 10, 5}});
  add_open_box(scene, {{30, 0, 0}, {30, 0, 0}});      // a point
  add_open_box(scene, {{20, -5, 0}, {20, 5, 1e9f}});  // a sheet, very tall
  ViewCells cells;
  add_cell(cells, 0, 0);                                     // within a box
  cells.corners.insert(cells.corners.end(), 3, {15, 0, 0});  // a point
  cells.corners.insert(cells.corners.end(), {{-1e9f, 0, 0}, {1e9f, 0, 0}, {0, 1e9f, 0}});
  const VisibilityMatrix objects = climb(scene, cells).seen;
  EXPECT_EQ(row(objects, 0), Ids{0});
  EXPECT_EQ(row(objects, 1), (Ids{0, 2}));
}

TEST(Climbing, RefusesToLookNowhereAndFromBoxes) {
  for (const auto member :
       {&ProducerOptions::passes, &ProducerOptions::viewpoints, &ProducerOptions::directions}) {
    ProducerOptions options;
    options.*member = 0;
    EXPECT_THROW(climb({}, {}, options), std::invalid_argument);
  }
  ProducerOptions options;
  options.enough = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(climb({}, {}, options), std::invalid_argument);
  ViewCells boxes;
  boxes.boxes = {{{0, 0, 0}, {1, 1, 1}}};
  EXPECT_THROW(climb({}, boxes), std::invalid_argument);
}

TEST(Climbing, ProgressEndsAtAll) {
  Scene scene;
  add_open_box(scene, {{10, 10, 0}, {20, 20, 5}});
  ViewCells cells;
  add_cell(cells, 0, 0);
  std::uint64_t last = 0, of = 1, calls = 0;
  ThreadJobRunner runner;
  producer_named("climbing").see(scene, cells, {}, runner, [&](const char*) {
    return [&](std::uint64_t done, std::uint64_t total) {
      EXPECT_LE(done, total);
      last = done, of = total, ++calls;
    };
  });
  EXPECT_GT(calls, 1u);
  EXPECT_EQ(last, of);
}

}  // namespace
}  // namespace vismat
