// Tests the producers on scenes whose visibility is known.
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "tests/visibility/analytic_scenes.h"
#include "visibility/rays/aimed_rays.h"
#include "visibility/shadows/shadow.h"

namespace vismat {
namespace {

std::vector<std::uint32_t> every_object(const Scene& scene) {
  std::vector<std::uint32_t> objects(scene.object_count);
  std::iota(objects.begin(), objects.end(), 0u);
  return objects;
}

TEST(AnalyticScenes, ShadowsHideWhatIsHiddenAlone) {
  int hidden = 0, found = 0;
  for (const AnalyticScene& s : analytic_scenes()) {
    SCOPED_TRACE(s.name);
    OccluderOptions options;
    options.smallest = 0.05f;
    ViewCells cells;
    cells.boxes = {s.cell};
    const Shadows shadows(s.scene, occluders_for(s.scene, cells, options));
    ShadowOptions casting;
    casting.resolution = casting.patch_resolution = 128, casting.patches = 60;
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
      } else {
        ++hidden, found += in_the_end;
      }
    }
  }
  EXPECT_GE(found, hidden * 2 / 3);
}

TEST(AnalyticScenes, WhoLooksFromBelowTheGroundSeesUnderWhatStandsOnIt) {
  AnalyticScene s{"", {{-1, -1, -5}, {1, 1, -4}}};
  s.box(Truth::seen, {{-20, 10, 0}, {20, 11, 20}});
  s.box(Truth::seen, {{-1, 20, 0}, {1, 21, 2}});
  ViewCells cells;
  cells.boxes = {s.cell};
  for (const bool below : {true, false}) {
    const Shadows shadows(s.scene, occluders_for(s.scene, cells, {}));
    const auto seen = shadows.view({})->not_hidden(convex_box(s.cell));
    EXPECT_EQ(seen.size(), below ? 2u : 1u);
    s.cell = cells.boxes[0] = {{-1, -1, 0}, {1, 1, 2}};
  }
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
  EXPECT_GE(found, seen * 9 / 10);
}

}  // namespace
}  // namespace vismat
