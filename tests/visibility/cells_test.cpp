// View cells of any scene, against what is known of scenes of boxes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <stdexcept>

#include "matrix/base/random.h"
#include "tests/sanitized.h"
#include "visibility/cells/cells_choice.h"
#include "visibility/cells/grid_cells.h"
#include "visibility/cells/ground_cells.h"
#include "visibility/cells/octree_cells.h"
#include "visibility/generators/city.h"
#include "visibility/generators/dense_city.h"
#include "visibility/rays/ray_caster.h"

namespace vismat {
namespace {

/// A closed box as an object of its own; `inward`: triangles face the wrong way.
void put_box(Scene& scene, const Box& box, bool inward = false) {
  static constexpr std::uint32_t triangles[12][3] = {{0, 1, 5}, {0, 5, 4}, {1, 3, 7}, {1, 7, 5},
                                                     {3, 2, 6}, {3, 6, 7}, {2, 0, 4}, {2, 4, 6},
                                                     {4, 5, 7}, {4, 7, 6}, {0, 3, 1}, {0, 2, 3}};
  const auto first = static_cast<std::uint32_t>(scene.vertices.size());
  for (unsigned corner = 0; corner < 8; ++corner) {
    scene.vertices.emplace_back((corner & 1 ? box.high : box.low)[0], (corner & 2 ? box.high : box.low)[1],
                                (corner & 4 ? box.high : box.low)[2]);
  }
  for (const auto& t : triangles) {
    for (unsigned i = 0; i < 3; ++i) scene.indices.push_back(first + t[inward ? 2 - i : i]);
    scene.object_of_triangle.push_back(scene.object_count);
  }
  ++scene.object_count;
}

bool within(const Box& inner, const Box& outer) {
  for (unsigned axis = 0; axis < 3; ++axis)
    if (inner.low[axis] < outer.low[axis] || inner.high[axis] > outer.high[axis]) return false;
  return true;
}

double volume(const Box& box) {
  double product = 1;
  for (unsigned axis = 0; axis < 3; ++axis) product *= double{box.high[axis]} - box.low[axis];
  return product;
}

bool overlap(const Box& a, const Box& b) {
  for (unsigned axis = 0; axis < 3; ++axis)
    if (a.low[axis] >= b.high[axis] || b.low[axis] >= a.high[axis]) return false;
  return true;
}

bool has(const ViewCells& cells, const Box& box) {
  return std::find(cells.boxes.begin(), cells.boxes.end(), box) != cells.boxes.end();
}

/// Boxes with gaps between them, some of them turned inside out.
std::vector<Box> random_boxes(std::uint64_t seed, float offset) {
  Random random(seed);
  std::vector<Box> boxes;
  for (unsigned i = 0; i < 27; ++i) {
    const std::array<unsigned, 3> place = {i % 3, i / 3 % 3, i / 9};
    Box box;
    for (unsigned axis = 0; axis < 3; ++axis) {
      box.low[axis] =
          offset + 4 * static_cast<float>(place[axis]) + 0.25f * static_cast<float>(random.below(4));
      box.high[axis] = box.low[axis] + 0.75f + 0.25f * static_cast<float>(random.below(9));
    }
    boxes.push_back(box);
  }
  return boxes;
}

TEST(GridCells, AreAllButThoseWithinABox) {
  for (const float offset : {0.0f, -7.3f, 20000.0f}) {
    for (std::uint64_t seed = 0; seed < 8; ++seed) {
      const std::vector<Box> boxes = random_boxes(seed, offset);
      Scene scene;
      for (const Box& box : boxes) put_box(scene, box, seed % 2 == 1);
      GridCellsOptions options;
      options.size = {1, 1, 1};
      options.region = {{offset - 1, offset - 1, offset - 1}, {offset + 12, offset + 12, offset + 12}};
      const ViewCells cells = make_grid_cells(scene, options);
      std::size_t kept = 0;
      for (float z = -1; z < 12; ++z) {
        for (float y = -1; y < 12; ++y) {
          for (float x = -1; x < 12; ++x) {
            const Box cell = {{offset + x, offset + y, offset + z},
                              {offset + x + 1, offset + y + 1, offset + z + 1}};
            const bool solid =
                std::any_of(boxes.begin(), boxes.end(), [&](const Box& box) { return within(cell, box); });
            ASSERT_EQ(has(cells, cell), !solid) << x << ' ' << y << ' ' << z << ", seed " << seed;
            kept += !solid;
          }
        }
      }
      EXPECT_EQ(cells.count(), kept);
      EXPECT_EQ(transpose(*cells.neighbours), *cells.neighbours);
    }
  }
}

/// A hollow block: its walls reach from `outer` to `inner`, with a door of `door` metres or none.
Scene hollow(float door) {
  Scene scene;
  put_box(scene, {{0, 0, 0}, {8, 8, 0.5f}});
  put_box(scene, {{0, 0, 3.5f}, {8, 8, 4}});
  put_box(scene, {{0, 0, 0}, {0.5f, 8, 4}});
  put_box(scene, {{7.5f, 0, 0}, {8, 8, 4}});
  put_box(scene, {{0, 7.5f, 0}, {8, 8, 4}});
  if (door > 0) {
    put_box(scene, {{0, 0, 0}, {4 - door / 2, 0.5f, 4}});
    put_box(scene, {{4 + door / 2, 0, 0}, {8, 0.5f, 4}});
  } else {
    put_box(scene, {{0, 0, 0}, {8, 0.5f, 4}});
  }
  return scene;
}

TEST(GridCells, ViewersComeThroughDoorsAlone) {
  GridCellsOptions options;
  options.size = {1, 1, 1};
  options.region = {{-2, -2, 0}, {10, 10, 6}};
  const Box inside = {{4, 4, 1}, {5, 5, 2}};
  EXPECT_FALSE(has(make_grid_cells(hollow(0), options), inside));
  EXPECT_TRUE(has(make_grid_cells(hollow(1), options), inside));
  options.viewers.from = {{4.1f, 4.2f, 1.3f}};
  const ViewCells shut_in = make_grid_cells(hollow(0), options);
  EXPECT_TRUE(has(shut_in, inside));
  for (const Box& box : shut_in.boxes) EXPECT_TRUE(overlap(box, {{0.5f, 0.5f, 0.5f}, {7.5f, 7.5f, 3.5f}}));
  EXPECT_EQ(shut_in.count(), 8u * 8 * 4) << "walls cut the outer ones, which count";
  EXPECT_GT(make_grid_cells(hollow(1), options).count(), shut_in.count());
}

TEST(GridCells, WhereAViewerStands) {
  GridCellsOptions options;
  options.size = {1, 1, 0.5f};
  options.region = {{-2, -2, 0}, {10, 10, 7}};
  options.viewers.eyes = {{1.6f, 1.8f}};
  const ViewCells cells = make_grid_cells(hollow(1), options);
  EXPECT_TRUE(has(cells, {{-1, -1, 1.5f}, {0, 0, 2}})) << "on the ground";
  EXPECT_FALSE(has(cells, {{-1, -1, 1}, {0, 0, 1.5f}}));
  EXPECT_FALSE(has(cells, {{-1, -1, 2}, {0, 0, 2.5f}}));
  EXPECT_TRUE(has(cells, {{4, 4, 2}, {5, 5, 2.5f}})) << "on the floor";
  EXPECT_FALSE(has(cells, {{4, 4, 3}, {5, 5, 3.5f}}));
  EXPECT_TRUE(has(cells, {{4, 4, 5.5f}, {5, 5, 6}})) << "on the roof";
  options.viewers.eyes = {{3.1f, 3.1f}};
  EXPECT_FALSE(has(make_grid_cells(hollow(1), options), {{4, 4, 3.5f}, {5, 5, 4}})) << "no head room";
}

TEST(GridCells, MayBeFlat) {
  GridCellsOptions options;
  options.size = {2, 2, 0};
  options.region = {{-2, -2, 1.7f}, {10, 10, 1.7f}};
  const ViewCells cells = make_grid_cells(hollow(0), options);
  EXPECT_EQ(cells.count(), 36u - 16);
  EXPECT_EQ(cells.boxes[0], (Box{{-2, -2, 1.7f}, {0, 0, 1.7f}}));
}

TEST(GridCells, EndWithTheirRegion) {
  GridCellsOptions options;
  options.size = {2, 2, 2};
  options.region = {{-2, -2, 0}, {3, 3, 3}};
  const ViewCells cells = make_grid_cells(hollow(1), options);
  Box all = cells.boxes[0];
  for (const Box& box : cells.boxes) {
    for (unsigned axis = 0; axis < 3; ++axis) {
      all.low[axis] = std::min(all.low[axis], box.low[axis]);
      all.high[axis] = std::max(all.high[axis], box.high[axis]);
      EXPECT_NEAR(box.high[axis] - box.low[axis], axis == 2 ? 1.5 : 5. / 3, 1e-5);  // evenly smaller
    }
  }
  EXPECT_EQ(all, *options.region);
}

TEST(OctreeCells, AreCutWhereTheirRegionEnds) {
  OctreeCellsOptions options;
  options.levels = 3;
  options.threshold = 0;
  options.region = {{-2, -2, 0}, {3, 3, 2}};
  const auto one = [](const ViewCells& cells) { return std::vector<std::uint64_t>(cells.count(), 1); };
  for (const Box& box : make_octree_cells(hollow(1), one, options).cells.boxes) {
    for (unsigned axis = 0; axis < 3; ++axis) {
      EXPECT_LE(box.high[axis], options.region->high[axis]);
      EXPECT_GT(box.high[axis], box.low[axis]);
    }
  }
}

TEST(GridCells, TheSameForAnyNumberOfThreads) {
  GridCellsOptions options;
  options.size = {0.3f, 0.3f, 0.3f};
  options.region = {{-2, -2, 0}, {10, 10, 6}};
  options.threads = 1;
  const ViewCells once = make_grid_cells(hollow(1), options);
  options.threads = 3;
  const ViewCells again = make_grid_cells(hollow(1), options);
  EXPECT_EQ(once.boxes, again.boxes);
  EXPECT_EQ(once.neighbours, again.neighbours);
}

TEST(GridCells, RefusesWhatCannotBe) {
  const auto refused = [](const std::function<void(GridCellsOptions&)>& change, const Scene& scene) {
    GridCellsOptions options;
    change(options);
    EXPECT_THROW(make_grid_cells(scene, options), std::invalid_argument);
  };
  const Scene scene = hollow(1);
  refused([](GridCellsOptions& o) { o.size.x = 0; }, scene);
  refused([](GridCellsOptions& o) { o.size.y = -1; }, scene);
  refused([](GridCellsOptions& o) { o.size.z = std::nanf(""); }, scene);
  refused([](GridCellsOptions& o) { o.size = {1e-3f, 1e-3f, 1e-3f}; }, scene);
  refused([](GridCellsOptions& o) { o.region = {{1, 0, 0}, {0, 1, 1}}; }, scene);
  refused(
      [](GridCellsOptions& o) {
        o.region = {{3, 3, 1}, {5, 5, 1}}, o.viewers.from = {{9, 9, 9}};
      },
      scene);
  refused([](GridCellsOptions& o) { o.viewers.eyes = {{2, 1}}; }, scene);
  refused([](GridCellsOptions&) {}, Scene{});
  // The region lies within walls: nobody gets there.
  refused([](GridCellsOptions& o) { o.size = {1, 1, 1}, o.region = {{0.1f, 1, 1}, {0.4f, 2, 2}}; }, scene);
}

/// More triangles the nearer a cell comes to a point, and from the larger cell: as visibility is.
VisibleTriangles nearer_is_more(const glm::vec3& point) {
  return [point](const ViewCells& cells) {
    std::vector<std::uint64_t> triangles;
    for (const Box& box : cells.boxes) {
      double squared = 0;
      for (unsigned axis = 0; axis < 3; ++axis) {
        const double x = point[static_cast<int>(axis)];
        const double away = std::max({double{box.low[axis]} - x, x - double{box.high[axis]}, 0.0});
        squared += away * away;
      }
      triangles.push_back(static_cast<std::uint64_t>(1e6 / (1 + squared)));
    }
    return triangles;
  };
}

TEST(OctreeCells, LeavesCoverWhatViewersReachOnce) {
  const std::vector<Box> boxes = random_boxes(3, 0);
  Scene scene;
  for (const Box& box : boxes) put_box(scene, box);
  OctreeCellsOptions options;
  options.region = {{0, 0, 0}, {12, 12, 10}};
  options.levels = 4;
  options.threshold = 20000;
  const OctreeCells octree = make_octree_cells(scene, nearer_is_more({3, 4, 5}), options);
  const ViewCells& cells = octree.cells;
  ASSERT_EQ(octree.triangles.size(), cells.count());
  for (std::uint32_t a = 0; a < cells.count(); ++a) {
    for (std::uint32_t b = 0; b < a; ++b)
      ASSERT_FALSE(overlap(cells.boxes[a], cells.boxes[b])) << a << ' ' << b;
    for (const Box& box : boxes) ASSERT_FALSE(within(cells.boxes[a], box)) << a;
  }
  GridCellsOptions smallest;
  smallest.region = options.region;
  smallest.size = {0.75f, 0.75f, 0.75f};
  for (const Box& small : make_grid_cells(scene, smallest).boxes) {
    EXPECT_EQ(std::count_if(cells.boxes.begin(), cells.boxes.end(),
                            [&](const Box& box) { return within(small, box); }),
              1);
  }
  EXPECT_EQ(transpose(*cells.neighbours), *cells.neighbours);
  // Counts add up, level by level.
  std::uint64_t kept = 0, stopped = 0;
  for (std::size_t level = 0; level < octree.levels.size(); ++level) {
    const OctreeLevel& l = octree.levels[level];
    kept += l.kept;
    stopped += l.stopped;
    EXPECT_LE(l.kept, l.evaluated);
    EXPECT_TRUE(l.stopped == 0 || level == options.levels);
    if (level + 1 < octree.levels.size()) {
      EXPECT_LE(octree.levels[level + 1].evaluated, 8 * (l.evaluated - l.kept));
    }
  }
  EXPECT_EQ(kept, cells.count());
  EXPECT_EQ(octree.levels.size(), 5u);
  EXPECT_GT(stopped, 0u);
  EXPECT_GT(octree.levels.back().excess, 1);
  EXPECT_EQ(stopped, static_cast<std::uint64_t>(
                         std::count_if(octree.triangles.begin(), octree.triangles.end(),
                                       [&](std::uint64_t t) { return t > options.threshold; })));
  const std::string table = table_of(octree);
  EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), 6) << table;
}

TEST(OctreeCells, ALowerThresholdRefines) {
  Scene scene;
  put_box(scene, {{0, 0, 0}, {1, 1, 1}});
  OctreeCellsOptions options;
  options.region = {{0, 0, 0}, {16, 16, 16}};
  options.levels = 4;
  OctreeCells coarser;
  for (const std::uint64_t threshold : {2000000, 200000, 30000, 8000, 0}) {
    options.threshold = threshold;
    OctreeCells finer = make_octree_cells(scene, nearer_is_more({9, 8.5f, 3}), options);
    for (const Box& box : finer.cells.boxes) {
      if (coarser.cells.count() == 0) break;
      EXPECT_TRUE(std::any_of(coarser.cells.boxes.begin(), coarser.cells.boxes.end(),
                              [&](const Box& whole) { return within(box, whole); }));
    }
    EXPECT_GE(finer.cells.count(), coarser.cells.count());
    coarser = std::move(finer);
    EXPECT_EQ(coarser.cells.count() == 1, threshold == 2000000);
    double covered = 0;
    for (const Box& box : coarser.cells.boxes) covered += volume(box);
    // All of the cube but the box, which a cell of a metre fills.
    EXPECT_NEAR(covered, threshold == 0 ? 16 * 16 * 16 - 1 : 16 * 16 * 16, 1 + 1e-3);
  }
  EXPECT_EQ(coarser.cells.count(), 16u * 16 * 16 - 1);
}

TEST(OctreeCells, RefusesWhatCannotBe) {
  const Scene scene = hollow(1);
  const VisibleTriangles none = [](const ViewCells&) { return std::vector<std::uint64_t>{}; };
  EXPECT_THROW(make_octree_cells(scene, none), std::invalid_argument);
  OctreeCellsOptions options;
  options.levels = 11;
  EXPECT_THROW(make_octree_cells(scene, nearer_is_more({}), options), std::invalid_argument);
}

double area(const ViewCells& cells) {
  double sum = 0;
  for (std::uint32_t cell = 0; cell < cells.prisms(); ++cell) {
    const glm::vec3* c = &cells.corners[std::size_t{3} * cell];
    sum += 0.5 * ((double{c[1].x} - c[0].x) * (double{c[2].y} - c[0].y) -
                  (double{c[1].y} - c[0].y) * (double{c[2].x} - c[0].x));
  }
  return sum;
}

/// How many cells have the point of the plan and the height in them.
int cells_at(const ViewCells& cells, float x, float y, float z) {
  int count = 0;
  for (std::uint32_t cell = 0; cell < cells.prisms(); ++cell) {
    const Convex prism = convex_of(cells, cell);
    count += std::all_of(prism.faces.begin(), prism.faces.end(), [&](const Convex::Face& face) {
      return face.normal.x * x + face.normal.y * y + face.normal.z * (z + cells.eye_low) <=
             face.offset + 1e-5;
    });
  }
  return count;
}

TEST(GroundCells, GoAroundTheBoxesOfACity) {
  CityOptions size_4;
  size_4.size = 4;
  const Scene scene = make_city(size_4).scene;
  GroundCellsOptions options;
  options.height = 0;
  options.region = {{0, 0, 0}, {80, 80, 30}};
  const ViewCells cells = make_ground_cells(scene, options);
  double expected = 80 * 80;
  for (const Box& box : object_bounds(scene)) {
    expected -=
        (box.high[0] - box.low[0] + 2 * options.radius) * (box.high[1] - box.low[1] + 2 * options.radius);
    for (const float x : {box.low[0], (box.low[0] + box.high[0]) / 2, box.high[0]}) {
      for (const float y : {box.low[1], (box.low[1] + box.high[1]) / 2, box.high[1]}) {
        EXPECT_EQ(cells_at(cells, x, y, 0), 0) << "outlines and insides of boxes are out of reach";
      }
    }
    EXPECT_GE(cells_at(cells, box.low[0] - 1.1f * options.radius, box.low[1] + 1, 0), 1);
  }
  EXPECT_NEAR(area(cells), expected, 0.1);
  EXPECT_GE(cells.count(), 6u * 16 + 2) << "as the city's own";
  EXPECT_LE(cells.count(), 7u * 16 + 2) << "a box may get one corner more";
  EXPECT_EQ(transpose(*cells.neighbours), *cells.neighbours);
  EXPECT_GE(cells.neighbours->ones(), 3u * cells.count() - 5 * 16 - 4) << "all sides but the borders";
}

TEST(GroundCells, LeadThroughDoorsAndUnderRoofs) {
  for (const float door : {0.0f, 1.0f, 0.15f}) {
    Scene scene = hollow(door);
    put_box(scene, {{-4, -4, -1}, {12, 12, 0}});  // the ground, with an underside
    GroundCellsOptions options;
    const ViewCells cells = make_ground_cells(scene, options);
    EXPECT_EQ(cells_at(cells, -2.1f, -2.3f, 0), 1);
    EXPECT_EQ(cells_at(cells, -2.1f, -2.3f, -1), 0) << "nobody walks under the ground";
    EXPECT_EQ(cells_at(cells, 4.1f, 4.2f, 4), 0) << "nor gets onto the roof";
    // The floor is half a metre above the ground, which is more than a step.
    EXPECT_EQ(cells_at(cells, 4.1f, 4.2f, 0.5f), 0);
    options.step = 0.6f;
    EXPECT_EQ(cells_at(make_ground_cells(scene, options), 4.1f, 4.2f, 0.5f), door > 0.5f);
    options.viewers.from = {{4, 4, 3}};
    EXPECT_EQ(cells_at(make_ground_cells(scene, options), 4.1f, 4.2f, 0.5f), 1);
    EXPECT_EQ(cells_at(make_ground_cells(scene, options), -2.1f, -2.3f, 0), door > 0.5f);
    options.viewers.eyes = {{3.1f, 3.2f}};
    EXPECT_THROW(make_ground_cells(scene, options), std::invalid_argument) << "no head room inside";
  }
}

TEST(GroundCells, ClimbStairsAndSlopes) {
  Scene scene;
  put_box(scene, {{0, 0, -1}, {20, 10, 0}});
  for (int i = 0; i < 8; ++i) {  // stairs up to a gallery, over a part of the ground
    const auto at = static_cast<float>(i);
    put_box(scene, {{5 + at / 2, 2, 0.375f * at}, {5.5f + at / 2, 4, 0.375f * (at + 1)}});
  }
  put_box(scene, {{9, 0, 2.75f}, {20, 10, 3}});
  const auto first = static_cast<std::uint32_t>(scene.vertices.size());  // a slope down to another field
  for (const glm::vec3& corner : {glm::vec3(0, 0, 0), glm::vec3(0, 10, 0), glm::vec3(-10, 10, -5),
                                  glm::vec3(-10, 0, -5), glm::vec3(-20, 10, -5), glm::vec3(-20, 0, -5)}) {
    scene.vertices.push_back(corner);
  }
  for (const std::uint32_t corner : {0, 1, 2, 0, 2, 3, 3, 2, 4, 3, 4, 5})
    scene.indices.push_back(first + corner);
  for (int i = 0; i < 4; ++i) scene.object_of_triangle.push_back(0);
  const ViewCells cells = make_ground_cells(scene);
  EXPECT_EQ(cells_at(cells, 2.1f, 3.2f, 0), 1);
  EXPECT_EQ(cells_at(cells, 15.1f, 5.2f, 0), 1) << "under the gallery";
  EXPECT_EQ(cells_at(cells, 15.1f, 5.2f, 3), 1) << "on it";
  EXPECT_EQ(cells_at(cells, -5.1f, 5.2f, -2.55f), 1) << "on the slope";
  EXPECT_EQ(cells_at(cells, -15.1f, 5.2f, -5), 1) << "beyond it";
  GroundCellsOptions options;
  options.step = 0.3f;
  EXPECT_EQ(cells_at(make_ground_cells(scene, options), 15.1f, 5.2f, 3) +
                cells_at(make_ground_cells(scene, options), 15.1f, 5.2f, 0),
            1)
      << "steps too high";
  options = {};
  options.steepest = 20;
  EXPECT_EQ(cells_at(make_ground_cells(scene, options), -15.1f, 5.2f, -5), 0);
}

TEST(GroundCells, ViewersHaveRoomAndCellsDoNotOverlap) {
  DenseCityOptions small;
  small.size = test::sanitized ? 2 : 3;
  small.interiors = 0.5f;
  small.car_parks = 0.2f;
  small.car_sides = 12;
  const Scene scene = make_dense_city(small).scene;
  const RayCaster caster(scene);
  const GroundCellsOptions options;
  const ViewCells cells = make_ground_cells(scene, options);
  EXPECT_GT(area(cells), 1000);
  Random random(1);
  std::uint32_t tested = 0;
  constexpr std::uint32_t every = test::sanitized ? 160 : 24;
  for (std::uint32_t cell = 0; cell < cells.prisms(); ++cell) {
    const glm::vec3* c = &cells.corners[std::size_t{3} * cell];
    const auto [i, j] = std::minmax({random.unit(), random.unit()});
    const glm::vec3 feet = c[0] * i + c[1] * (j - i) + c[2] * (1 - j);
    if (cell % every == 0) {  // each is looked for in all cells
      const auto found = cells_at(cells, feet.x, feet.y, feet.z);
      ASSERT_LE(found, 2) << "two where the point lies on an edge";
      tested += found == 1;
    }
    for (const float x : {-0.5f, 0.0f, 0.5f}) {  // some of the radius is given away for straight edges
      const glm::vec3 at = feet + glm::vec3(x * options.radius, x * options.radius, options.step + 1e-3f);
      ASSERT_GE(caster.hit(at, {0, 0, 1.6f - options.step}).distance, 1) << cell;
    }
    ASSERT_NEAR(caster.hit(feet + glm::vec3(0, 0, 0.2f), {0, 0, -1}).distance, 0.2f, 2e-3f) << "no ground";
  }
  EXPECT_GT(tested, cells.prisms() / every * 9 / 10);
}

TEST(GroundCells, TheSameForAnyNumberOfThreads) {
  GroundCellsOptions options;
  options.threads = 1;
  options.step = 0.6f;
  const ViewCells once = make_ground_cells(hollow(1), options);
  options.threads = 3;
  EXPECT_EQ(once.corners, make_ground_cells(hollow(1), options).corners);
}

TEST(GroundCells, RefusesWhatCannotBe) {
  const auto refused = [](const std::function<void(GroundCellsOptions&)>& change) {
    GroundCellsOptions options;
    change(options);
    EXPECT_THROW(make_ground_cells(hollow(1), options), std::invalid_argument);
  };
  refused([](GroundCellsOptions& o) { o.steepest = 90; });
  refused([](GroundCellsOptions& o) { o.radius = 0; });
  refused([](GroundCellsOptions& o) { o.viewers.eyes = {{2, 1}}; });
  refused([](GroundCellsOptions& o) { o.viewers.eyes.reset(); });
  refused([](GroundCellsOptions& o) { o.viewers.from = {{40, 40, 9}}; });
  refused([](GroundCellsOptions& o) { o.region = {{100, 100, 0}, {120, 120, 9}}; });
  EXPECT_THROW(make_ground_cells(Scene{}), std::invalid_argument);
}

TEST(CellsChoice, ReadsWords) {
  const auto grid = std::get<GridCellsOptions>(
      parse_cells({"grid:4,4,1.5", "-1,-2.5,0,1e2,2,3", {"1,2,3", "-4,5,6"}, "1.6,1.8"}));
  EXPECT_EQ(grid.size, glm::vec3(4, 4, 1.5f));
  EXPECT_EQ(grid.region, (Box{{-1, -2.5f, 0}, {100, 2, 3}}));
  EXPECT_EQ(grid.viewers.from, (std::vector<glm::vec3>{{1, 2, 3}, {-4, 5, 6}}));
  EXPECT_EQ(grid.viewers.eyes, (std::array{1.6f, 1.8f}));
  EXPECT_EQ(std::get<GridCellsOptions>(parse_cells({"grid:0.25", "", {}, ""})).size, glm::vec3(0.25f));
  const auto octree = std::get<OctreeCellsOptions>(parse_cells({"octree:5000", "", {}, "1.7"}));
  EXPECT_EQ(octree.threshold, 5000u);
  EXPECT_EQ(octree.levels, OctreeCellsOptions{}.levels);
  EXPECT_EQ(octree.viewers.eyes, (std::array{1.7f, 1.7f}));
  EXPECT_EQ(std::get<OctreeCellsOptions>(parse_cells({"octree:5000:3", "", {}, ""})).levels, 3u);
  EXPECT_EQ(std::get<GroundCellsOptions>(parse_cells({"ground", "", {}, ""})).viewers.eyes,
            (std::array{1.6f, 1.6f}));
  EXPECT_EQ(std::get<GroundCellsOptions>(parse_cells({"ground:-2.5", "", {}, "1,2"})).height, -2.5f);
  EXPECT_TRUE(std::holds_alternative<std::monostate>(parse_cells({})));
  EXPECT_NE(describe(CellsChoice{grid}), describe(CellsChoice{GridCellsOptions{}}));
}

TEST(CellsChoice, RefusesOtherWords) {
  for (const char* cells : {"", "grid", "grid:", "grid:4m", "grid:1,2", "grid:nan", "grid:1e30", "grid:4:4",
                            "octree", "octree:", "octree:-3", "octree:5:x", "octree:5:6:7",
                            "ground:", "ground:1:2", "ground:1,2", "file:1", "cubes:3"}) {
    EXPECT_THROW(parse_cells({cells, "", {}, ""}), std::invalid_argument) << cells;
  }
  for (const char* region : {"1,2,3", "0,0,0,1,1,-1", "0,0,0,1,1,inf", "0,0,0,1,1,1,"}) {
    EXPECT_THROW(parse_cells({"grid:1", region, {}, ""}), std::invalid_argument) << region;
  }
  EXPECT_THROW(parse_cells({"grid:1", "", {"1,2"}, ""}), std::invalid_argument);
  for (const char* eyes : {"2,1", "-1", "1,2,3", "high"}) {
    EXPECT_THROW(parse_cells({"grid:1", "", {}, eyes}), std::invalid_argument) << eyes;
  }
  EXPECT_THROW(parse_cells({"file", "", {}, "1.6"}), std::invalid_argument);
  EXPECT_THROW(choose_cells(hollow(0), {}, {}, {}), std::invalid_argument) << "the scene has no cells";
}

TEST(CellsChoice, CountsTriangles) {
  EXPECT_EQ(triangles_of_rows(VisibilityMatrix::from_rows({{0, 2}, {}, {1}}, 7), hollow(0)).size(), 3u);
  EXPECT_EQ(triangles_of_rows(VisibilityMatrix::from_rows({{0, 2}, {}, {1}}, 7), hollow(0))[0], 24u);
}

}  // namespace
}  // namespace vismat
