// Small scenes whose visibility is known by reasoning, for every producer's tests.
#pragma once
#include <array>
#include <glm/vec3.hpp>
#include <string>
#include <utility>
#include <vector>

#include "tests/sanitized.h"
#include "visibility/scene.h"
#include "visibility/shadows/occluders.h"

namespace vismat {

/// What is true of an object seen from the cell. Jointly: hidden, but some point of it by no single occluder from the whole
/// cell, so that only smaller patches of the cell's border can prove it.
enum class Truth { seen, hidden, hidden_jointly };

struct AnalyticScene {
  std::string name;
  Box cell;
  Scene scene{};
  std::vector<Occluder> occluders{};  // hand-made; sound, and enough to prove what is hidden
  std::vector<Truth> truth{};         // one for each object

  /// Another object; or, with `more`, another part of the last one.
  void box(Truth what, const Box& b, bool more = false) {
    const std::uint32_t first = begin(what, more);
    for (unsigned c = 0; c < 8; ++c) {
      scene.vertices.emplace_back((c & 1 ? b.high : b.low)[0], (c & 2 ? b.high : b.low)[1],
                                  (c & 4 ? b.high : b.low)[2]);
    }
    for (const auto& [p, q, r, s] :
         {std::array{0u, 4u, 6u, 2u}, std::array{1u, 3u, 7u, 5u}, std::array{0u, 1u, 5u, 4u},
          std::array{2u, 6u, 7u, 3u}, std::array{0u, 2u, 3u, 1u}, std::array{4u, 5u, 7u, 6u}}) {
      triangle(first + p, first + q, first + r);
      triangle(first + p, first + r, first + s);
    }
    occluders.push_back({convex_box(b), scene.object_count - 1, false});
  }
  /// A rectangle across the y axis.
  void pane(Truth what, float y, std::array<float, 2> x, std::array<float, 2> z, bool glass = false) {
    const std::uint32_t first = begin(what, false);
    const std::array<glm::dvec3, 4> corners = {
        {{x[0], y, z[0]}, {x[1], y, z[0]}, {x[1], y, z[1]}, {x[0], y, z[1]}}};
    for (const glm::dvec3& corner : corners) scene.vertices.emplace_back(corner);
    triangle(first, first + 1, first + 2);
    triangle(first, first + 2, first + 3);
    if (glass) {
      scene.see_through.resize(scene.object_count);
      scene.see_through.back() = 1;
    } else {
      occluders.push_back({convex_polygon(corners, {0, -1, 0}), scene.object_count - 1, true});
    }
  }

 private:
  std::uint32_t begin(Truth what, bool more) {
    if (!more) {
      ++scene.object_count;
      truth.push_back(what);
      if (!scene.see_through.empty()) scene.see_through.push_back(0);
    }
    return static_cast<std::uint32_t>(scene.vertices.size());
  }
  void triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    scene.indices.insert(scene.indices.end(), {a, b, c});
    scene.object_of_triangle.push_back(scene.object_count - 1);
  }
};

/// As they are thought of: y leads away from the cell, most of it is symmetric in x and z.
inline std::vector<AnalyticScene> plain_analytic_scenes() {
  constexpr float eps = 1.0f / 64;  // still there when the scene is 1e5 m away
  const Box small{{-1, -1, -1}, {1, 1, 1}};
  const Box flat{{-1, 0, -1}, {1, 0, 1}};
  using enum Truth;
  std::vector<AnalyticScene> all;
  const auto start = [&](const char* name, const Box& cell) -> AnalyticScene& {
    return all.emplace_back(AnalyticScene{name, cell});
  };

  for (const auto& [name, cell] : {std::pair("wall", small), std::pair("wall, flat cell", flat),
                                   std::pair("wall, line as cell", Box{{-1, 0, 0}, {1, 0, 0}}),
                                   std::pair("wall, point as cell", Box{{0, 0, 0}, {0, 0, 0}})}) {
    AnalyticScene& s = start(name, cell);
    s.box(seen, {{-20, 10, -20}, {20, 11, 20}});
    s.box(hidden, {{-1, 20, 0}, {1, 22, 2}});
    s.box(seen, {{-1, 5, 0}, {1, 6, 2}});           // in front
    s.box(seen, {{-2, 9, -2}, {2, 15, 2}});         // half through the wall
    s.box(hidden, {{5, 10.25, 5}, {6, 10.75, 6}});  // within it
    s.box(seen, {{-8, 9, 5}, {-6, 10, 7}});         // touches its front
    s.box(hidden, {{-8, 11, 5}, {-6, 12, 7}});      // touches its back
    s.box(seen, {{-1, -6, -1}, {1, -5, 1}});        // on the other side of the cell
  }
  {  // The cell is wider than the wall: behind it the umbra narrows and ends after D R / (r - R) = 8 * 2 / (4 - 2).
    AnalyticScene& s = start("umbra that ends", {{-4, 0, -4}, {4, 0, 4}});
    s.pane(seen, 8, {-2, 2}, {-2, 2});
    s.pane(hidden, 12, {-1 + eps, 1 - eps}, {-1 + eps, 1 - eps});  // at y it is 2 - (y - 8) / 4 wide each way
    s.pane(seen, 17, {-eps, eps}, {-eps, eps});                    // beyond the tip
    s.box(seen, {{3, 10, -1}, {4, 11, 1}});
  }
  for (const float side : {-1.f, 1.f}) {
    AnalyticScene& s =
        start(side < 0 ? "just inside the umbra" : "just out of the umbra", {{-4, 0, -4}, {4, 0, 4}});
    s.pane(seen, 8, {-2, 2}, {-2, 2});
    s.pane(side < 0 ? hidden : seen, 12, {0, 1 + side * eps}, {0, 0.5f});
    // A solid: from (1, 0) past its edge at (2, 8), so 3 wide at 16.
    AnalyticScene& t = start(side < 0 ? "box just hidden by a box" : "box just seen behind a box", flat);
    t.box(seen, {{-2, 8, -20}, {2, 9, 20}});
    t.box(side < 0 ? hidden : seen, {{-3 + eps, 16, 0}, {3 + side * eps, 17, 1}});
  }
  for (const float gap : {1.f, eps, 1.0f / 4096}) {
    AnalyticScene& s = start(gap == 1     ? "gap of 1 m"
                             : gap == eps ? "gap of 1/64 m"
                                          : "gap of 1/4096 m",
                             small);
    s.box(seen, {{-40, 10, -20}, {-gap / 2, 11, 20}});
    s.box(seen, {{gap / 2, 10, -20}, {40, 11, 20}});
    s.box(seen, {{-1, 20, -1}, {1, 21, 1}});
    s.box(hidden, {{5, 20, -1}, {6, 21, 1}});  // the lines through the gap pass it: 1 * (20 - 1) / 9 < 5
  }
  {  // Past the first wall's edge at x = 1 a line leads away from x = 0, where the second begins.
    AnalyticScene& s = start("two walls that overlap", small);
    s.box(seen, {{-40, 10, -20}, {1, 11, 20}});
    s.box(seen, {{0, 12, -20}, {40, 13, 20}});
    s.box(hidden, {{-5, 20, -1}, {5, 21, 1}});
  }
  {  // The first hides it from the cell's left part, the second from the right.
    AnalyticScene& s = start("joint occlusion", {{-4, 0, -1}, {4, 0, 1}});
    s.pane(seen, 10, {-10, 0.25f}, {-20, 20});
    s.pane(seen, 11, {0, 10}, {-20, 20});
    s.box(hidden_jointly, {{-0.125f, 20, -1}, {0.125f, 21, 1}});
  }
  for (const bool aligned :
       {true, false}) {  // from a door in [-.5, .5] to one in [1, 2] no line comes back to [-.5, .5]
    AnalyticScene& s = start(aligned ? "corridor, doors in line" : "corridor, doors out of line", small);
    for (int wall = 0; wall < 3; ++wall) {
      const float y = static_cast<float>(4 + 4 * wall), door = wall == 1 && !aligned ? 1.5f : 0;
      // Of the last wall only the right part is seen through two doors out of line.
      s.box(wall == 2 && !aligned ? hidden : seen, {{-30, y, -20}, {door - 0.5f, y + 0.25f, 20}});
      s.box(seen, {{door + 0.5f, y, -20}, {30, y + 0.25f, 20}});
    }
    s.box(aligned ? seen : hidden, {{-0.25f, 16, -1}, {0.25f, 17, 1}});
  }
  for (const bool covered :
       {false, true}) {  // a window frame is one object of four boxes and hides not what its hull does
    AnalyticScene& s = start(covered ? "frame with a pane behind it" : "frame with a hole", small);
    s.box(seen, {{-20, 8, -20}, {-1, 9, 20}});
    s.box(seen, {{1, 8, -20}, {20, 9, 20}}, true);
    s.box(seen, {{-2, 8, 1}, {2, 9, 20}}, true);
    s.box(seen, {{-2, 8, -20}, {2, 9, -1}}, true);
    if (covered) s.pane(seen, 9.5f, {-3, 3}, {-3, 3});
    s.box(covered ? hidden : seen, {{-0.5f, 12, -0.5f}, {0.5f, 13, 0.5f}});
  }
  {
    AnalyticScene& s = start("cell on both sides of a wall", small);
    s.box(seen, {{-20, -0.125f, -20}, {20, 0.125f, 20}});
    s.box(seen, {{-1, 10, -1}, {1, 11, 1}});
    s.box(seen, {{-1, -11, -1}, {1, -10, 1}});
    s.box(seen, {{0.5f, 0.5f, 0.5f}, {3, 3, 3}});                  // reaches into the cell
    s.box(seen, {{-0.5f, 0.5f, -0.5f}, {-0.25f, 0.75f, -0.25f}});  // within it
    s.box(seen, {{1, 0.5f, -1}, {2, 0.75f, -0.5f}});               // touches it
  }
  {
    AnalyticScene& s = start("pictures on a wall", small);
    s.box(seen, {{-20, 8, -20}, {20, 9, 20}});
    s.pane(seen, 8, {-1, 1}, {-1, 1});
    s.pane(seen, 8, {-1, 1}, {-1, 1});  // the same rectangle again
    s.pane(hidden, 9, {-1, 1}, {-1, 1});
  }
  {
    AnalyticScene& s = start("glass", small);
    s.pane(seen, 8, {-20, 20}, {-20, 20}, true);
    s.box(seen, {{-1, 12, -1}, {1, 13, 1}});
    s.box(seen, {{-20, 16, -20}, {20, 17, 20}});
    s.box(hidden, {{-1, 20, -1}, {1, 21, 1}});
  }
  {  // In a hollow box, whose six sides are what hides.
    AnalyticScene& s = start("cell in a box", small);
    s.box(seen, {{-10, -10, -10}, {10, 10, 10}});
    s.occluders.clear();
    for (const float y : {-10.f, 10.f}) {
      s.occluders.push_back(
          {convex_polygon(std::array<glm::dvec3, 4>{{{-10, y, -10}, {10, y, -10}, {10, y, 10}, {-10, y, 10}}},
                          {0, -1, 0}),
           0, true});
    }
    s.box(hidden, {{-1, 20, -1}, {1, 21, 1}});
    s.box(hidden, {{-1, -21, -1}, {1, -20, 1}});
    s.box(seen, {{4, 4, 4}, {5, 5, 5}});
  }
  {  // Nothing but a needle stands out above the wall.
    AnalyticScene& s = start("needle over a wall", flat);
    s.box(seen, {{-20, 8, -20}, {20, 9, 2}});
    s.box(seen, {{0, 16, -1},
                 {eps, 16 + eps, 5 + eps}});  // from z = -1 past z = 2 at 9, to 4.33 at 16; from z = 1 lower
    s.box(hidden, {{4, 16, -1}, {4 + eps, 16 + eps, 3 - eps}});  // from z = 1 past z = 2 at 8, to 3 at 16
  }
  return all;
}

/// Those, with their axes exchanged so that y leads along each of the three, and, where the coordinates still are what they
/// were, 1e5 metres away. Under sanitizers only what they were and one far away.
inline std::vector<AnalyticScene> analytic_scenes() {
  std::vector<AnalyticScene> all;
  for (const AnalyticScene& plain : plain_analytic_scenes()) {
    for (int turns = 0; turns < 3; ++turns) {
      for (const float offset : {0.f, 1e5f}) {
        if (test::sanitized && (turns == 2 || (turns == 1) != (offset != 0))) continue;
        AnalyticScene s = plain;
        s.name += turns == 0 ? "" : turns == 1 ? ", along z" : ", along x";
        if (offset != 0) s.name += ", far away";
        bool exact = true;
        const auto move = [&](auto& p) {  // anything with three coordinates
          const auto old = p;
          for (int k = 0; k < 3; ++k) {
            p[(k + turns) % 3] = old[k] + offset;
            exact = exact && p[(k + turns) % 3] - offset == old[k];
          }
        };
        move(s.cell.low), move(s.cell.high);
        for (glm::vec3& vertex : s.scene.vertices) move(vertex);
        for (Occluder& occluder : s.occluders) {
          for (glm::dvec3& vertex : occluder.shape.vertices) move(vertex);
          for (Convex::Face& face : occluder.shape.faces) {
            const glm::dvec3 normal = face.normal;
            for (int k = 0; k < 3; ++k) face.normal[(k + turns) % 3] = normal[k];
            face.offset = farthest_beyond(occluder.shape.vertices, face.normal, 0);
          }
        }
        if (exact) all.push_back(std::move(s));
      }
    }
  }
  return all;
}

}  // namespace vismat
