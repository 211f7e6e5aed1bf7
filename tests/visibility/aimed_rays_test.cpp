#include "visibility/rays/aimed_rays.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "tests/visibility/open_boxes.h"
#include "visibility/geometry/convex.h"

namespace vismat {
namespace {

using Ids = std::vector<std::uint32_t>;

/// What is seen of all objects, each sight line traced again.
Ids seen_from(const Scene& scene, const Convex& cell, std::uint64_t rays = 20000) {
  const RayCaster caster(scene);
  const AimedRays aimed(scene, caster);
  const CellPoints points(cell);
  Ids all(scene.object_count), ids;
  std::iota(all.begin(), all.end(), 0u);
  for (const auto& [object, line] : aimed.from(points, all, rays, Random(1)).objects) {
    ids.push_back(object);
    EXPECT_TRUE(points.contains(line.from));
    if (line.from == line.to) continue;
    const Hit hit = caster.hit(line.from, line.to - line.from);
    EXPECT_NE(hit.triangle, Hit::nothing);
    if (hit.triangle == Hit::nothing) continue;
    EXPECT_EQ(scene.object_of_triangle[hit.triangle], object);
    EXPECT_NEAR(hit.distance, 1, 1e-4);
  }
  return ids;
}

TEST(AimedRays, WallHidesWhatIsBehindIt) {
  Scene scene;
  add_open_box(scene, {{-100, 10, 0}, {100, 11, 10}});
  add_open_box(scene, {{-5, -20, 0}, {5, -15, 5}});
  add_open_box(scene, {{-5, 20, 0}, {5, 25, 5}});
  EXPECT_EQ(seen_from(scene, convex_box({{-1, -1, 1}, {1, 1, 2}})), (Ids{0, 1}));
}

TEST(AimedRays, ThroughASlit) {
  Scene scene;
  add_open_box(scene, {{-100, 20, 0}, {-0.005f, 21, 50}});
  add_open_box(scene, {{0.005f, 20, 0}, {100, 21, 50}});
  add_open_box(scene, {{-10, 100, 0}, {10, 110, 20}});
  EXPECT_EQ(seen_from(scene, convex_box({{-2, -2, 1}, {2, 2, 2}}), 200000), (Ids{0, 1, 2}));
}

TEST(AimedRays, JustOverAWall) {
  // From the highest eye at the back of the cell the wall's near edge rises 3 m in 10 m, and so to 32 m at the tower.
  for (const float centimetre : {-1.f, 1.f}) {
    Scene scene;
    add_open_box(scene, {{-1000, 10, 0}, {1000, 11, 5}});
    add_open_box(scene, {{-5, 100, 0}, {5, 110, 32 + 0.01f * centimetre}});
    EXPECT_EQ(seen_from(scene, convex_box({{-2, 0, 1}, {2, 1, 2}}), 100000).size(), centimetre > 0 ? 2u : 1u);
  }
}

TEST(AimedRays, FromWithinABoxAndWhatTouches) {
  Scene scene;
  add_open_box(scene, {{-10, -10, 0}, {10, 10, 5}});  // round the cell
  add_open_box(scene, {{30, 0, 0}, {40, 10, 5}});     // outside of that
  add_open_box(scene, {{1, -1, 1}, {2, 1, 2}});       // touches the cell
  add_open_box(scene, {{-1, -1, 2}, {1, 1, 3}});      // an open one on top of it, in common an edge
  EXPECT_EQ(seen_from(scene, convex_box({{-1, -1, 1}, {1, 1, 2}})), (Ids{0, 2, 3}));
  EXPECT_EQ(seen_from(scene, convex_box({{1, 0, 1.5f}, {1, 0, 1.5f}})), Ids{2}) << "on a wall";
}

TEST(AimedRays, FlatAndSlopingCellsFarOut) {
  for (const float x : {0.f, 1e5f}) {
    Scene scene;
    add_open_box(scene, {{x - 100, 10, 0}, {x + 100, 11, 10}});
    add_open_box(scene, {{x - 5, 20, 0}, {x + 5, 25, 5}});
    add_open_box(scene, {{x - 5, -25, 0}, {x + 5, -20, 5}});
    EXPECT_EQ(seen_from(scene, convex_prism({{{x, 0, 0}, {x + 2, 0, 1}, {x, 3, 0.5f}}}, 1, 2)), (Ids{0, 2}));
    EXPECT_EQ(seen_from(scene, convex_box({{x, 0, 1}, {x, 1, 2}})), (Ids{0, 2}));
    EXPECT_EQ(seen_from(scene, convex_box({{x, 0, 1}, {x, 0, 1}})), (Ids{0, 2}));
  }
}

TEST(AimedRays, OnlyTargetsAndNoMoreRays) {
  Scene scene;
  add_open_box(scene, {{-100, 10, 0}, {100, 11, 10}});
  add_open_box(scene, {{-5, -20, 0}, {5, -15, 5}});
  add_open_box(scene, {{-5, 20, 0}, {5, 25, 5}});
  ++scene.object_count;  // one without triangles
  const RayCaster caster(scene);
  const AimedRays aimed(scene, caster);
  const CellPoints cell(convex_box({{-1, -1, 1}, {1, 1, 2}}));
  const Ids targets = {1, 2, 3};
  const AimedRays::Seen seen = aimed.from(cell, targets, 1000, Random(1));
  ASSERT_EQ(seen.objects.size(), 1u);
  EXPECT_EQ(seen.objects[0].object, 1u);
  EXPECT_EQ(seen.rays, 1000u);
  EXPECT_EQ(aimed.from(cell, targets, 1000, Random(1)).objects, seen.objects);
  EXPECT_NE(aimed.from(cell, targets, 1000, Random(2)).objects, seen.objects);
  EXPECT_EQ(aimed.from(cell, {}, 1000, Random(1)).rays, 0u);
  EXPECT_TRUE(aimed.from(cell, targets, 0, Random(1)).objects.empty());
}

}  // namespace
}  // namespace vismat
