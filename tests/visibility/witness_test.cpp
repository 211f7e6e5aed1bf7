#include "visibility/exact/witness.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <numeric>

#include "tests/sanitized.h"
#include "tests/visibility/analytic_scenes.h"
#include "visibility/exact/line_space.h"

namespace vismat {
namespace {

glm::vec3 vertex(const Scene& scene, std::uint32_t object) {
  const auto& owners = scene.object_of_triangle;
  return scene
      .vertices[scene.indices[3 * static_cast<std::size_t>(std::find(owners.begin(), owners.end(), object) -
                                                           owners.begin())]];
}

std::vector<std::uint32_t> all_of(const std::vector<Occluder>& occluders) {
  std::vector<std::uint32_t> ids(occluders.size());
  std::iota(ids.begin(), ids.end(), 0u);
  return ids;
}

HiddenWitness from_whole_cell(const AnalyticScene& s) {
  HiddenWitness::Part part;
  part.patch.corners = convex_box(s.cell).vertices;
  part.occluders = all_of(s.occluders);
  HiddenWitness witness;
  witness.parts.push_back(std::move(part));
  return witness;
}

constexpr int strips_of_face = 32;

HiddenWitness from_strips(const AnalyticScene& s) {
  const Convex cell = convex_box(s.cell);
  HiddenWitness witness;
  for (const Convex::Face& face : cell.faces) {
    std::array<glm::dvec3, 4> c;
    for (std::size_t i = 0; i < 4; ++i) c[i] = cell.vertices[face.corners[i]];
    if (glm::distance(c[1], c[2]) > glm::distance(c[0], c[1])) std::rotate(c.begin(), c.begin() + 1, c.end());
    if (glm::distance(c[0], c[1]) == 0 || glm::distance(c[1], c[2]) == 0) continue;
    for (int i = 0; i < strips_of_face; ++i) {
      const auto at = [&](int a, int b, int k) {
        return c[a] + (c[b] - c[a]) * (k / double{strips_of_face});
      };
      witness.parts.push_back(
          {{{at(0, 1, i), at(0, 1, i + 1), at(3, 2, i + 1), at(3, 2, i)}, Plane{face.normal, face.offset}},
           {},
           all_of(s.occluders)});
    }
  }
  return witness;
}

TEST(Witness, SightLines) {
  std::uint64_t lines = 0, aimed_again = 0;
  for (const AnalyticScene& s : analytic_scenes()) {
    SCOPED_TRACE(s.name);
    const WitnessCheck check(s.scene);
    const Convex cell = convex_box(s.cell);
    const glm::vec3 low(s.cell.low[0], s.cell.low[1], s.cell.low[2]),
        high(s.cell.high[0], s.cell.high[1], s.cell.high[2]);
    for (std::uint32_t object = 0; object < s.scene.object_count; ++object) {
      const glm::vec3 corner = vertex(s.scene, object);
      if (s.truth[object] != Truth::seen) {
        EXPECT_TRUE(check.seen(cell, object, {(low + high) / 2.0f, corner})) << "object " << object;
        EXPECT_TRUE(check.seen(cell, object, {corner, corner}));
        EXPECT_TRUE(check.seen(cell, object, {low, low}));
        continue;
      }
      const LineSpaceAnswer answer = look_in_line_space(s.scene, s.occluders, cell, object);
      SightLine line;
      if (answer.sight_line) {
        line = {glm::vec3((*answer.sight_line)[0]), glm::vec3((*answer.sight_line)[1])};
      } else {
        line.from = line.to = glm::clamp(corner, low, high);
      }
      EXPECT_EQ(check.seen(cell, object, line, &aimed_again), std::nullopt) << "object " << object;
      ++lines;
      const glm::vec3 aside(0, 0.5f, 0);
      EXPECT_TRUE(
          check.seen(cell, object, {line.from, high + (high - low) + aside}));  // not on the object, mostly
      EXPECT_TRUE(check.seen(cell, object, {high + aside, line.to}));
      EXPECT_TRUE(check.seen(cell, object, {line.from, line.to * std::nanf("")}));
    }
  }
  EXPECT_GT(lines, test::sanitized ? 100u : 300u);
  EXPECT_LT(aimed_again, lines / 20);
}

TEST(Witness, LinesThatPassAnEdgeAreAimedAgain) {
  AnalyticScene s{"", {{-1, 0, -1}, {1, 0, 1}}};
  s.pane(Truth::seen, 8, {-2, 0}, {-2, 2});
  s.pane(Truth::seen, 16, {-9, 9}, {-2, 2});
  std::uint64_t aimed_again = 0;
  const WitnessCheck check(s.scene);
  EXPECT_EQ(check.seen(convex_box(s.cell), 1, {{0, 0, 0.1f}, {0, 16, 0.1f}}, &aimed_again), std::nullopt);
  EXPECT_EQ(aimed_again, 1u);
  EXPECT_TRUE(check.seen(convex_box(s.cell), 1, {{-0.5f, 0, 0.1f}, {-0.5f, 16, 0.1f}}, &aimed_again));
}

Doubt doubt_of(const AnalyticScene& s, std::uint32_t object, const HiddenWitness& witness,
               std::uint32_t samples = 24) {
  return WitnessCheck(s.scene).hidden(convex_box(s.cell), object, witness, s.occluders, samples, Random(7));
}

// Samples may miss what is seen of an object, as they do where a wall is seen in part through two doors.
TEST(Witness, WhatHidesFromTheWholeCell) {
  int refuted = 0, missed = 0;
  for (const AnalyticScene& s : analytic_scenes()) {
    SCOPED_TRACE(s.name);
    for (std::uint32_t object = 0; object < s.scene.object_count; ++object) {
      const Doubt doubt = doubt_of(s, object, from_whole_cell(s));
      if (s.truth[object] == Truth::hidden) {
        EXPECT_EQ(doubt, std::nullopt) << "object " << object;
      } else {
        ++(doubt ? refuted : missed);
      }
    }
  }
  EXPECT_GT(refuted, test::sanitized ? 100 : 300);
  EXPECT_LE(missed, 6);
}

TEST(Witness, WhatHidesFromPatches) {
  int refuted = 0, missed = 0;
  for (const AnalyticScene& s : plain_analytic_scenes()) {
    SCOPED_TRACE(s.name);
    const HiddenWitness strips = from_strips(s);
    if (strips.parts.empty()) continue;  // a cell without area
    for (std::uint32_t object = 0; object < s.scene.object_count; object += test::sanitized ? 6 : 1) {
      const Doubt doubt = doubt_of(s, object, strips, 12);
      if (s.truth[object] == Truth::seen) {
        ++(doubt ? refuted : missed);
        continue;
      }
      EXPECT_EQ(doubt, std::nullopt) << "object " << object;
      for (int half = 0; half < test::trials(2); ++half) {  // each leaves a hole
        HiddenWitness some;
        for (std::size_t i = 0; i < strips.parts.size(); ++i) {
          if ((i % strips_of_face < strips_of_face / 2) == (half == 0)) some.parts.push_back(strips.parts[i]);
        }
        EXPECT_TRUE(doubt_of(s, object, some, 12)) << "object " << object;
      }
      HiddenWitness nothing = strips;
      for (HiddenWitness::Part& part : nothing.parts) part.occluders.clear();
      EXPECT_TRUE(doubt_of(s, object, nothing, 12));
    }
  }
  EXPECT_GT(refuted, test::sanitized ? 7 : 50);
  EXPECT_LE(missed, 1);
}

TEST(Witness, OccludersMustBeMadeOfTriangles) {
  AnalyticScene s{"", {{-1, -1, -1}, {1, 1, 1}}};
  s.box(Truth::seen, {{-20, 10, -20}, {-1, 11, 20}});
  s.box(Truth::seen, {{1, 10, -20}, {20, 11, 20}}, true);
  s.box(Truth::seen, {{-1, 20, -1}, {1, 21, 1}});
  s.occluders = {{convex_box({{-20, 10, -20}, {20, 11, 20}}), 0, false}};  // the hull of both: not there
  const Doubt doubt =
      WitnessCheck(s.scene).hidden(convex_box(s.cell), 1, from_whole_cell(s), s.occluders, 8, Random(1));
  ASSERT_TRUE(doubt);
  EXPECT_NE(doubt->find("but no triangle of its object 0"), std::string::npos) << *doubt;
}

}  // namespace
}  // namespace vismat
