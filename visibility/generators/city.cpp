// ALGORITHM. Every box keeps to its own grid square, half the narrowest street away from its border, so no
// two can touch. Ground rectangle minus boxes is one polygon with size^2 holes; GEOS triangulates it
// (constrained Delaunay: every wall's foot is an edge of some cell, no cell enters a box). GEOS promises no
// order of the triangles, so they are sorted: by grid square along the Z-curve, which keeps rows that see
// alike together, then by position.
#include "visibility/generators/city.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "matrix/base/random.h"
#include "matrix/base/z_order.h"
#include "visibility/cells/ground_triangles.h"

namespace vismat {
namespace {

constexpr std::uint32_t largest_size = 128;  // GEOS takes minutes for the holes of the next

void check(const CityOptions& o) {
  const auto refuse = [](const std::string& what) { throw std::invalid_argument("city: " + what); };
  if (!std::has_single_bit(o.size) || o.size > largest_size) {
    refuse("size " + std::to_string(o.size) + " is not a power of two from 1 to " +
           std::to_string(largest_size));
  }
  for (const float length : {o.pitch, o.smallest_side, o.lowest, o.eye_low, o.narrowest_street}) {
    if (!(length > 0 && length <= 1e4f)) refuse("lengths must be above 0 and at most 10000 m");
  }
  if (!(o.largest_side >= o.smallest_side && o.highest >= o.lowest && o.eye_high >= o.eye_low)) {
    refuse("the largest of something is below its smallest");
  }
  if (!(o.highest <= 1e4f && o.eye_high <= 1e4f)) refuse("heights must be at most 10000 m");
  if (!(o.largest_side + o.narrowest_street <= o.pitch)) {
    refuse("a largest side and a narrowest street do not fit into the pitch");
  }
  if (!(o.jitter >= 0 && o.jitter <= 1)) refuse("jitter must lie between 0 and 1");
}

std::vector<Box> place_boxes(const CityOptions& o) {
  Random random(o.seed);
  std::vector<Box> boxes(std::size_t{o.size} * o.size);
  for (std::uint32_t y = 0; y < o.size; ++y) {
    for (std::uint32_t x = 0; x < o.size; ++x) {
      Box& box = boxes[z_order(x, y)];
      const std::array<std::uint32_t, 2> square = {x, y};
      for (unsigned axis = 0; axis < 2; ++axis) {
        const float side = random.between(o.smallest_side, o.largest_side);
        const float room = (o.pitch - o.narrowest_street - side) / 2 * o.jitter;
        const float middle =
            (static_cast<float>(square[axis]) + 0.5f) * o.pitch + random.between(-room, room);
        box.low[axis] = middle - side / 2;
        box.high[axis] = middle + side / 2;
      }
      box.high[2] = random.between(o.lowest, o.highest);
    }
  }
  return boxes;
}

void add_box(Scene& scene, const Box& box) {
  // Corner bits: 1 = high x, 2 = high y, 4 = high z. No floor: nobody sees it.
  static constexpr std::uint32_t triangles[10][3] = {{0, 1, 5}, {0, 5, 4}, {1, 3, 7}, {1, 7, 5}, {3, 2, 6},
                                                     {3, 6, 7}, {2, 0, 4}, {2, 4, 6}, {4, 5, 7}, {4, 7, 6}};
  const auto first = static_cast<std::uint32_t>(scene.vertices.size());
  for (unsigned corner = 0; corner < 8; ++corner) {
    scene.vertices.emplace_back((corner & 1 ? box.high : box.low)[0], (corner & 2 ? box.high : box.low)[1],
                                (corner & 4 ? box.high : box.low)[2]);
  }
  for (const auto& triangle : triangles) {
    for (const std::uint32_t corner : triangle) scene.indices.push_back(first + corner);
    scene.object_of_triangle.push_back(scene.object_count);
  }
  ++scene.object_count;
}

void sort_by_square(std::vector<Triangle>& triangles, const CityOptions& o) {
  const auto key = [&](const Triangle& t) {
    const glm::vec3 centroid = (t[0] + t[1] + t[2]) / 3.0f;
    const auto square = [&](float x) {
      return static_cast<std::uint32_t>(
          std::clamp(std::floor(x / o.pitch), 0.0f, static_cast<float>(o.size - 1)));
    };
    return std::tuple(z_order(square(centroid.x), square(centroid.y)), centroid.x, centroid.y);
  };
  std::sort(triangles.begin(), triangles.end(),
            [&](const auto& a, const auto& b) { return key(a) < key(b); });
}

ObjectTree quadtree(std::uint32_t objects) {
  std::vector<std::uint32_t> parent_of_node, object_of_node;
  const auto add = [&](const auto& self, std::uint32_t parent, std::uint32_t first,
                       std::uint32_t count) -> void {
    const auto node = static_cast<std::uint32_t>(parent_of_node.size());
    parent_of_node.push_back(parent);
    object_of_node.push_back(count == 1 ? first : ObjectTree::none);
    for (std::uint32_t k = 0; k < 4 && count > 1; ++k) self(self, node, first + k * (count / 4), count / 4);
  };
  add(add, ObjectTree::none, 0, objects);
  return ObjectTree::from_parents(std::move(parent_of_node), std::move(object_of_node), objects);
}

}  // namespace

SceneFile make_city(const CityOptions& options) {
  check(options);
  const std::vector<Box> boxes = place_boxes(options);
  SceneFile city;
  for (const Box& box : boxes) add_box(city.scene, box);
  const float side = static_cast<float>(options.size) * options.pitch;
  std::vector<Triangle> triangles = triangulate_around({{0, 0, 0}, {side, side, 0}}, boxes);
  sort_by_square(triangles, options);
  for (const Triangle& t : triangles) city.cells.corners.insert(city.cells.corners.end(), t.begin(), t.end());
  city.cells.eye_low = options.eye_low;
  city.cells.eye_high = options.eye_high;
  city.cells.neighbours =
      VisibilityMatrix::from_rows(edge_neighbours(triangles), static_cast<std::uint32_t>(triangles.size()));
  city.tree = quadtree(city.scene.object_count);
  city.provenance = describe(options);
  city.seed = options.seed;
  return city;
}

std::string describe(const CityOptions& o) {
  char text[256];
  std::snprintf(
      text, sizeof text,
      "city: size %u, pitch %g m, narrowest street %g m, sides %g-%g m, heights %g-%g m, jitter %g, eyes "
      "%g-%g m, seed %llu",
      o.size, o.pitch, o.narrowest_street, o.smallest_side, o.largest_side, o.lowest, o.highest, o.jitter,
      o.eye_low, o.eye_high, static_cast<unsigned long long>(o.seed));
  return text;
}

}  // namespace vismat
