// The producers on scenes whose visibility is known.
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "tests/visibility/analytic_scenes.h"
#include "visibility/aimed_rays.h"
#include "visibility/shadow.h"

namespace vismat {
namespace {

std::vector<std::uint32_t> every_object(const Scene& scene) {
  std::vector<std::uint32_t> objects(scene.object_count);
  std::iota(objects.begin(), objects.end(), 0u);
  return objects;
}

TEST(AnalyticScenes, ShadowsHideWhatIsHiddenAlone) {
  int hidden = 0, found = 0, jointly = 0, found_jointly = 0;
  for (const AnalyticScene& s : analytic_scenes()) {
    SCOPED_TRACE(s.name);
    OccluderOptions options;
    options.smallest = 0.05f;
    options.extend_below_ground = s.cell.low[2] >= lowest_point(s.scene);
    const Shadows shadows(s.scene, find_occluders(s.scene, options));
    ShadowOptions casting;
    casting.resolution = 128, casting.patch_resolution = 128,
    casting.patches = std::count(s.truth.begin(), s.truth.end(), Truth::hidden_jointly) > 0 ? 1000 : 60;
    const auto view = shadows.view(casting);
    const Convex cell = convex_box(s.cell);
    const auto from_cell = view->not_hidden(cell), from_patches = view->refined(cell, from_cell, from_cell);
    for (std::uint32_t object = 0; object < s.scene.object_count; ++object) {
      const bool at_once = !std::binary_search(from_cell.begin(), from_cell.end(), object);
      const bool in_the_end = !std::binary_search(from_patches.begin(), from_patches.end(), object);
      const Truth truth = s.truth[object];
      if (truth == Truth::seen) {
        EXPECT_FALSE(at_once) << "object " << object;
        EXPECT_FALSE(in_the_end) << "object " << object;
      } else if (truth == Truth::hidden_jointly) {
        EXPECT_FALSE(at_once) << "object " << object;
        ++jointly, found_jointly += in_the_end;
      } else {
        ++hidden, found += in_the_end;
      }
    }
  }
  std::printf("hidden %d of %d, jointly %d of %d\n", found, hidden, found_jointly, jointly);
  EXPECT_GE(found, hidden * 2 / 3);
}

TEST(AnalyticScenes, RaysReachWhatIsSeenAlone) {
  int seen = 0, found = 0;
  for (const AnalyticScene& s : analytic_scenes()) {
    SCOPED_TRACE(s.name);
    const RayCaster caster(s.scene);
    const AimedRays rays(s.scene, caster);
    const auto targets = every_object(s.scene);
    const auto reached = rays.from(CellPoints(convex_box(s.cell)), targets, 3000, Random(1)).objects;
    for (const SeenObject& object : reached) {
      EXPECT_EQ(s.truth[object.object], Truth::seen) << "object " << object.object;
    }
    found += static_cast<int>(reached.size());
    seen += static_cast<int>(std::count(s.truth.begin(), s.truth.end(), Truth::seen));
  }
  std::printf("seen %d of %d\n", found, seen);
  EXPECT_GE(found, seen * 9 / 10);
}

}  // namespace
}  // namespace vismat
