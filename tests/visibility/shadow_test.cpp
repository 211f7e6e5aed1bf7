// Tests shadows of single occluders, and of several that are joined.
#include "visibility/shadows/shadow.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "matrix/base/random.h"
#include "tests/sanitized.h"
#include "visibility/rays/ray_caster.h"
#include "visibility/shadows/shadow_buffer.h"
#include "visibility/view_cells.h"

namespace vismat {
namespace {

using Objects = std::vector<std::uint32_t>;

glm::dvec3 some_point(Random& random, double reach) {
  return {(random.fraction() * 2 - 1) * reach, (random.fraction() * 2 - 1) * reach,
          (random.fraction() * 2 - 1) * reach};
}

Convex moved(Convex shape, double turn, double tilt, const glm::dvec3& by) {
  const auto rotate = [&](glm::dvec3 p) {
    p = {p.x * std::cos(turn) - p.y * std::sin(turn), p.x * std::sin(turn) + p.y * std::cos(turn), p.z};
    return glm::dvec3(p.x, p.y * std::cos(tilt) - p.z * std::sin(tilt),
                      p.y * std::sin(tilt) + p.z * std::cos(tilt));
  };
  for (glm::dvec3& vertex : shape.vertices) vertex = rotate(vertex) + by;
  for (Convex::Face& face : shape.faces) {
    face.normal = rotate(face.normal);
    face.offset = farthest_beyond(shape.vertices, face.normal, 0);
  }
  return shape;
}

/// A box of random size, turned and tilted.
Convex some_box(Random& random, double largest) {
  Box box;
  for (int axis = 0; axis < 3; ++axis) {
    box.high[axis] = static_cast<float>(0.2 + random.fraction() * largest);
    box.low[axis] = -box.high[axis];
  }
  return moved(convex_box(box), random.fraction() * 6, random.fraction() * 6, {});
}

/// Whether the segment meets the solid: cut by all of its faces.
bool meets(const Convex& solid, const glm::dvec3& from, const glm::dvec3& to) {
  double in = 0, out = 1;
  for (const Convex::Face& face : solid.faces) {
    const double a = glm::dot(face.normal, from) - face.offset, b = glm::dot(face.normal, to) - face.offset;
    if (a > 0 && b > 0) return false;
    if (a > 0) in = std::max(in, a / (a - b));
    if (b > 0) out = std::min(out, a / (a - b));
  }
  return in <= out + 1e-9;  // a plate has no thickness
}

/// A solid: a flat occluder as a plate.
bool hidden_from_vertices(const Convex& cell, const Convex& occluder, const glm::dvec3& x) {
  return std::all_of(cell.vertices.begin(), cell.vertices.end(),
                     [&](const glm::dvec3& from) { return meets(occluder, from, x); });
}

void add(Scene& scene, const Convex& shape) {
  const auto first = static_cast<std::uint32_t>(scene.vertices.size());
  for (const glm::dvec3& vertex : shape.vertices) scene.vertices.emplace_back(vertex);
  for (const Convex::Face& face : shape.faces) {
    for (std::size_t i = 1; i + 1 < face.corners.size(); ++i) {
      for (const std::uint16_t corner : {face.corners[0], face.corners[i], face.corners[i + 1]}) {
        scene.indices.push_back(first + corner);
      }
      scene.object_of_triangle.push_back(scene.object_count);
    }
  }
  ++scene.object_count;
}

/// Solids, each an object and its own occluder.
struct Solids {
  Scene scene;
  std::vector<Occluder> occluders;
  void add(const Convex& shape, bool occludes = true) {
    if (occludes) occluders.push_back({shape, scene.object_count, false});
    vismat::add(scene, shape);
  }
  void add(const Box& box, bool occludes = true) { add(convex_box(box), occludes); }
  Objects not_hidden(const Convex& cell, const ShadowOptions& options = {}) const {
    return Shadows(scene, occluders).view(options)->not_hidden(cell);
  }
  Objects refined(const Convex& cell, std::uint32_t patches, std::uint32_t resolution = 256) const {
    ShadowOptions options;
    options.patches = patches;
    options.patch_resolution = resolution;
    const Shadows shadows(scene, occluders);
    const auto view = shadows.view(options);
    const Objects around = view->not_hidden(cell);
    return view->refined(cell, around, around);
  }
};

TEST(SupportingPlanes, BoundTheUmbraExactly) {
  Random random(1);
  int inside = 0, points = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const bool flat = trial % 3 == 0;
    const Convex cell =
        trial % 2 ? some_box(random, 2) : convex_box({{-1, -1, 0}, {1, 1, trial % 4 == 0 ? 0.0f : 0.5f}});
    Convex occluder =
        flat ? convex_polygon(std::array<glm::dvec3, 4>{{{-3, 0, -3}, {3, 0, -3}, {2, 0, 3}, {-3, 0, 2}}},
                              {0, -1, 0})
             : some_box(random, 4);
    occluder = moved(occluder, random.fraction() - 0.5, random.fraction() - 0.5,
                     some_point(random, 2) + glm::dvec3(0, 9, 0));
    if (!apart(cell, occluder, 1e-9, flat)) continue;
    std::vector<Plane> planes;
    supporting_planes(cell, occluder, flat, planes);
    if (flat) occluder = convex_plate(occluder.vertices, occluder.faces[0].normal);
    for (int i = 0; i < 200; ++i) {
      const glm::dvec3 beyond = some_point(random, 6) + glm::dvec3(0, 24, 0);
      double least = 1e9;
      for (const Plane& plane : planes)
        least = std::min(least, glm::dot(plane.normal, beyond) - plane.offset);
      if (std::abs(least) < 1e-6) continue;
      ASSERT_EQ(least > 0, hidden_from_vertices(cell, occluder, beyond)) << "trial " << trial;
      inside += least > 0;
      ++points;
    }
  }
  EXPECT_GT(inside, points / 20);
}

// Whatever the buffer says is hidden has each of its corners in the umbra of a single solid that was drawn.
TEST(ShadowBuffer, HidesOnlyWhatASingleOccluderHidesPointByPoint) {
  Random random(2);
  ShadowBuffer buffer(256);
  int hidden = 0;
  for (const double far : {0.0, 1e5}) {
    for (int trial = 0; trial < 60; ++trial) {
      const glm::dvec3 origin(far, -far, far);
      const Convex cell =
          moved(trial % 2 ? some_box(random, 1) : convex_box({{-1, -1, 0}, {1, 1, 0}}), 0, 0, origin);
      buffer.clear(origin);
      std::vector<Convex> solids;
      for (int i = 0; i < 4; ++i) {
        const double angle = random.fraction() * 6;
        const Convex solid =
            moved(some_box(random, 5), 0, 0,
                  origin + glm::dvec3(9 * std::cos(angle), 9 * std::sin(angle), random.fraction() * 4 - 2));
        std::vector<Plane> planes;
        if (!apart(cell, solid, 1e-9 * (1 + far), false)) continue;
        supporting_planes(cell, solid, false, planes);
        if (buffer.draw(solid, planes)) solids.push_back(solid);
      }
      for (int i = 0; i < 400; ++i) {
        const glm::dvec3 at = origin + some_point(random, 30);
        Box box;
        for (int axis = 0; axis < 3; ++axis) {
          box.low[axis] = static_cast<float>(at[axis]);
          box.high[axis] = static_cast<float>(at[axis] + 0.5);
        }
        if (!buffer.hides(box)) continue;
        ++hidden;
        for (const glm::dvec3& corner : convex_box(box).vertices) {
          ASSERT_TRUE(std::any_of(solids.begin(), solids.end(), [&](const Convex& solid) {
            return hidden_from_vertices(cell, solid, corner);
          }));
        }
      }
    }
  }
  EXPECT_GT(hidden, 1000);
}

TEST(ShadowBuffer, HasNoSeams) {  // a closed room of six slabs around a point hides all outside
  ShadowBuffer buffer(64);
  buffer.clear({0.1, 0.2, 0.3});
  for (int axis = 0; axis < 3; ++axis) {
    for (const float side : {-1.0f, 1.0f}) {
      Box slab = {{-6, -6, -6}, {6, 6, 6}};
      slab.low[axis] = side > 0 ? 3.0f : -4.0f;
      slab.high[axis] = side > 0 ? 4.0f : -3.0f;
      EXPECT_TRUE(buffer.draw(convex_box(slab), {}));
    }
  }
  Random random(3);
  for (int i = 0; i < 2000; ++i) {
    glm::dvec3 direction = some_point(random, 1);
    direction *= 20 / glm::length(direction);
    Box box;
    for (int axis = 0; axis < 3; ++axis) {
      box.low[axis] = static_cast<float>(direction[axis]);
      box.high[axis] = box.low[axis] + 0.1f;
    }
    EXPECT_TRUE(buffer.hides(box)) << i;
  }
  EXPECT_FALSE(buffer.hides({{1, 1, 1}, {2, 2, 2}}));
  EXPECT_FALSE(buffer.hides({{1, 1, 1}, {20, 20, 20}}));
  EXPECT_FALSE(buffer.hides({{-1, -1, -1}, {1, 1, 1}}));  // around the point
}

TEST(ShadowBuffer, RefusesOddResolutions) {
  for (const std::uint32_t resolution : {0u, 8u, 100u, 8192u})
    EXPECT_THROW(ShadowBuffer{resolution}, std::invalid_argument);
}

// A wall 2 R wide at distance D from a cell 2 r wide: the umbra ends D R / (r - R) behind it if r > R, and never if not.
TEST(Shadow, UmbraOfAWallEndsWhereItMust) {
  const Convex cell = convex_box({{-2, 0, -2}, {2, 0, 2}});
  for (const float behind : {2.0f, 5.0f, 7.0f, 10.1f, 12.0f, 40.0f}) {
    Solids solids;
    solids.add({{-1, 10, -1}, {1, 10.001f, 1}});
    solids.add({{-0.0005f, 10 + behind, -0.0005f}, {0.0005f, 10 + behind + 0.001f, 0.0005f}}, false);
    EXPECT_EQ(solids.refined(cell, 200, 1024) == Objects{0}, behind < 10) << behind;
  }
}

TEST(Shadow, EveryLoneObjectIsVisible) {
  Random random(5);
  for (int trial = 0; trial < 50; ++trial) {
    Solids solids;
    solids.add(moved(some_box(random, 4), 0, 0, some_point(random, 12)));
    EXPECT_EQ(solids.refined(convex_box({{-1, -1, -1}, {1, 1, 1}}), 30), Objects{0});
  }
}

TEST(Shadow, AGapNarrowerThanAPixelStaysOpen) {
  Solids solids;
  solids.add({{-40, 10, -40}, {-0.0005f, 11, 40}});
  solids.add({{0.0005f, 10, -40}, {40, 11, 40}});
  solids.add({{-0.2f, 20, -0.2f}, {0.2f, 21, 0.2f}});
  for (const std::uint32_t patches : {0u, 64u}) {
    EXPECT_EQ(solids.refined(convex_box({{-1, 0, -1}, {1, 1, 1}}), patches), (Objects{0, 1, 2}));
  }
  solids.add({{-40, 11, -40}, {40, 12, 40}});
  EXPECT_EQ(solids.refined(convex_box({{-1, 0, -1}, {1, 1, 1}}), 64), (Objects{0, 1, 3}));
}

// Half of the cell is blocked by one wall, half by another, no part by none; neither hides the object alone.
TEST(Shadow, TwoOccludersHideJointlyOnlyFromPatches) {
  Solids solids;
  solids.add({{-30, 8, -30}, {0.3f, 8.5f, 30}});
  solids.add({{-0.3f, 12, -30}, {30, 12.5f, 30}});
  solids.add({{-0.1f, 30, -0.1f}, {0.1f, 30.2f, 0.1f}});
  const Convex cell = convex_box({{-2, 0, -1}, {2, 1, 1}});
  EXPECT_EQ(solids.not_hidden(cell), (Objects{0, 1, 2}));
  EXPECT_EQ(solids.refined(cell, 200), (Objects{0, 1}));
}

TEST(Shadow, AWallThroughTheCellHidesNothingFromIt) {
  Solids solids;
  solids.add({{-50, -0.1f, -50}, {50, 0.1f, 50}});
  solids.add({{-1, 20, -1}, {1, 21, 1}});
  solids.add({{-1, -21, -1}, {1, -20, 1}});
  for (const Box& cell :
       {Box{{-1, -1, -1}, {1, 1, 1}}, Box{{-1, 0.1f, -1}, {1, 1, 1}}, Box{{-1, -1, 0}, {1, 1, 0}}}) {
    const Objects seen = solids.refined(convex_box(cell), 60);
    EXPECT_TRUE(std::binary_search(seen.begin(), seen.end(), 0u));
    EXPECT_TRUE(std::binary_search(seen.begin(), seen.end(), 1u));
    EXPECT_EQ(std::binary_search(seen.begin(), seen.end(), 2u), cell.low[1] < 0);
  }
}

TEST(Shadow, AnObjectHalfThroughAWallIsVisible) {
  Solids solids;
  solids.add({{-50, 10, -50}, {50, 11, 50}});
  solids.add({{-1, 9.9f, -1}, {1, 30, 1}});      // sticks out a little
  solids.add({{-1, 11, 5}, {1, 30, 7}});         // touches it from behind
  solids.add({{5, 10, -1}, {6, 10, 1}}, false);  // a decal upon it
  EXPECT_EQ(solids.refined(convex_box({{-1, 0, -1}, {1, 1, 1}}), 40), (Objects{0, 1, 3}));
}

/// Large boxes all around the origin, and many small ones behind them.
Solids thicket(Random& random, const glm::dvec3& origin) {
  Solids solids;
  for (int i = 0; i < 200; ++i) {
    const bool large = i < 40;
    const glm::dvec3 direction = glm::normalize(some_point(random, 1));
    solids.add(moved(some_box(random, large ? 5 : 1), 0, 0,
                     origin + direction * (large ? 8 + random.fraction() * 6 : 15 + random.fraction() * 20)));
  }
  return solids;
}

TEST(Shadow, MorePointsHideMore) {
  Random random(6);
  const Solids solids = thicket(random, {});
  const Convex cell = convex_box({{-1, -1, -1}, {1, 1, 1}});
  ShadowOptions options;
  const Objects one = solids.not_hidden(cell, options);
  options.points = 27;
  const Objects all = solids.not_hidden(cell, options);
  EXPECT_LT(all.size(), one.size());
  EXPECT_TRUE(std::includes(one.begin(), one.end(), all.begin(), all.end()));
}

// The point of it all: from points of the cell, rays reach nothing that is called hidden. Every second scene lies far off.
TEST(Shadow, NeverHidesWhatARaySees) {
  Random random(4);
  std::uint64_t hidden = 0;
  for (int trial = 0; trial < test::trials(10); ++trial) {
    const glm::dvec3 origin = trial % 2 ? glm::dvec3(1e5, -1e5, 300) : glm::dvec3{};
    const Solids solids = thicket(random, origin);
    ViewCells cells;
    const auto corner = [&](double x, double y, double z) { return glm::vec3(origin + glm::dvec3(x, y, z)); };
    cells.corners = {corner(-1, -1, 0), corner(1, -1, 0.2), corner(0, 1, 0.5)};
    cells.eye_low = 0, cells.eye_high = trial % 3 ? 0.5f : 0.0f;
    const glm::vec3 low = corner(-1, -1, -1), high = corner(1, 1, trial % 4 ? 1 : -1);
    cells.boxes = {{{low.x, low.y, low.z}, {high.x, high.y, high.z}}};
    const RayCaster caster(solids.scene);
    const Shadows shadows(solids.scene, solids.occluders);
    ShadowOptions options;
    options.points = 9, options.patches = test::trials(60);
    const auto view = shadows.view(options);
    for (std::uint32_t cell = 0; cell < cells.count(); ++cell) {
      const Convex convex = convex_of(cells, cell);
      const Objects around = view->not_hidden(convex), left = view->refined(convex, around, around);
      hidden += solids.scene.object_count - left.size();
      for (int i = 0; i < test::trials(20000); ++i) {
        glm::dvec3 from{};
        double weights = 0;
        for (const glm::dvec3& vertex : convex.vertices) {
          const double weight = -std::log(1 - random.fraction());
          from += vertex * weight;
          weights += weight;
        }
        const Hit hit = caster.hit(glm::vec3(from / weights), glm::vec3(some_point(random, 1)));
        if (hit.triangle == Hit::nothing) continue;
        ASSERT_TRUE(
            std::binary_search(left.begin(), left.end(), solids.scene.object_of_triangle[hit.triangle]));
      }
    }
  }
  EXPECT_GT(hidden, 50 * test::trials(10u));
}

TEST(Shadow, TellsWhatHides) {
  Solids solids;
  solids.add({{-30, 8, -30}, {0.3f, 8.5f, 30}});
  solids.add({{-0.3f, 12, -30}, {30, 12.5f, 30}});
  solids.add({{-0.1f, 30, -0.1f}, {0.1f, 30.2f, 0.1f}});
  solids.add({{-10.1f, 20, -0.1f}, {-10, 20.2f, 0.1f}});
  ShadowOptions options;
  options.patches = 200;
  const Shadows shadows(solids.scene, solids.occluders);
  const auto view = shadows.view(options);
  const Convex cell = convex_box({{-2, 0, -1}, {2, 1, 1}});
  EXPECT_TRUE(view->witness(cell, 0).parts.empty());
  const HiddenWitness alone = view->witness(cell, 3);
  ASSERT_EQ(alone.parts.size(), 1u);
  EXPECT_EQ(alone.parts[0].occluders, Objects{0});
  const HiddenWitness both = view->witness(cell, 2);
  ASSERT_GT(both.parts.size(), 1u);
  Objects named;
  for (const HiddenWitness::Part& part : both.parts) {
    named.insert(named.end(), part.occluders.begin(), part.occluders.end());
    ASSERT_TRUE(part.patch.beyond.has_value());
  }
  EXPECT_NE(std::find(named.begin(), named.end(), 0u), named.end());
  EXPECT_NE(std::find(named.begin(), named.end(), 1u), named.end());
}

}  // namespace
}  // namespace vismat
