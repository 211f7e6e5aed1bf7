#include "visibility/generators/city.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "tests/sanitized.h"

namespace vismat {
namespace {

CityOptions of_size(std::uint32_t size) {
  CityOptions options;
  options.size = size;
  return options;
}

double area(const glm::vec3* t) {
  return (double{t[1].x} - t[0].x) * (double{t[2].y} - t[0].y) / 2 -
         (double{t[1].y} - t[0].y) * (double{t[2].x} - t[0].x) / 2;
}

/// Separating axes of a triangle and a rectangle on the ground; touching is not overlapping.
bool overlap(const glm::vec3* t, const Box& box) {
  std::vector<std::array<double, 2>> axes = {{1, 0}, {0, 1}};
  for (int i = 0; i < 3; ++i)
    axes.push_back({double{t[i].y} - t[(i + 1) % 3].y, double{t[(i + 1) % 3].x} - t[i].x});
  for (const auto& [x, y] : axes) {
    std::array<double, 3> of_triangle;
    for (int i = 0; i < 3; ++i) of_triangle[i] = x * t[i].x + y * t[i].y;
    std::array<double, 4> of_box;
    for (unsigned i = 0; i < 4; ++i)
      of_box[i] = x * (i & 1 ? box.low : box.high)[0] + y * (i & 2 ? box.low : box.high)[1];
    const auto [triangle_low, triangle_high] = std::minmax_element(of_triangle.begin(), of_triangle.end());
    const auto [box_low, box_high] = std::minmax_element(of_box.begin(), of_box.end());
    if (*triangle_high <= *box_low + 1e-6 || *box_high <= *triangle_low + 1e-6) return false;
  }
  return true;
}

TEST(City, HasThePublishedNumbersOfNodes) {
  for (const auto& [size, nodes, published_cells] :
       {std::array{32u, 1365u, 5766u}, std::array{64u, 5461u, 23814u}}) {
    if (test::sanitized && size > 32) continue;
    const SceneFile city = make_city(of_size(size));
    EXPECT_EQ(city.scene.object_count, size * size);
    EXPECT_EQ(city.tree->size(), nodes);
    EXPECT_EQ(city.cells.count(), 6 * size * size + 2);
    EXPECT_NEAR(city.cells.count(), published_cells, published_cells / 10);
  }
}

TEST(City, QuadtreeGroupsNeighbouringBoxes) {
  const SceneFile city = make_city(of_size(8));
  const ObjectTree& tree = *city.tree;
  ASSERT_EQ(tree.size(), 85u);
  const std::vector<Box> boxes = object_bounds(city.scene);
  std::uint32_t next_object = 0;
  for (std::uint32_t node = 0; node < tree.size(); ++node) {
    const auto children = tree.children(node);
    if (children.empty()) {
      EXPECT_EQ(tree.object_of_node()[node], next_object++);
    } else {
      ASSERT_EQ(children.size(), 4u) << node;
      EXPECT_EQ(tree.object_of_node()[node], ObjectTree::none);
      const std::uint32_t step = children[1] - children[0];
      EXPECT_TRUE(step == 1 || step == 5 || step == 21) << node;
      for (std::uint32_t k = 0; k < 4; ++k) EXPECT_EQ(children[k], node + 1 + k * step) << "depth first";
    }
  }
  EXPECT_EQ(next_object, 64u);
  for (std::uint32_t first = 0; first < 64; first += 4) {  // each lowest inner node covers two by two squares
    for (std::uint32_t k = 1; k < 4; ++k) {
      EXPECT_EQ(std::floor(boxes[first].low[0] / 40), std::floor(boxes[first + k].low[0] / 40));
      EXPECT_EQ(std::floor(boxes[first].low[1] / 40), std::floor(boxes[first + k].low[1] / 40));
    }
  }
}

TEST(City, CellsCoverTheGroundBetweenTheBoxes) {
  for (const std::uint32_t size : {1u, 2u, 8u}) {
    const SceneFile city = make_city(of_size(size));
    double covered = 0;
    for (const Box& box : object_bounds(city.scene)) {
      covered += (double{box.high[0]} - box.low[0]) * (double{box.high[1]} - box.low[1]);
    }
    for (std::uint32_t cell = 0; cell < city.cells.count(); ++cell) {
      EXPECT_GT(area(&city.cells.corners[3 * cell]), 0) << "cell " << cell << " is not counter-clockwise";
      covered += area(&city.cells.corners[3 * cell]);
    }
    EXPECT_NEAR(covered, 400.0 * size * size, 1e-3 * size * size);
  }
}

TEST(City, CellsStayOutOfTheBoxes) {
  const SceneFile city = make_city(of_size(8));
  const std::vector<Box> boxes = object_bounds(city.scene);
  for (std::uint32_t cell = 0; cell < city.cells.count(); ++cell) {
    for (const Box& box : boxes) ASSERT_FALSE(overlap(&city.cells.corners[3 * cell], box)) << "cell " << cell;
  }
}

TEST(City, NeighboursShareAnEdge) {
  const SceneFile city = make_city(of_size(8));
  const VisibilityMatrix& neighbours = *city.cells.neighbours;
  EXPECT_EQ(transpose(neighbours), neighbours);
  const auto corners = [&](std::uint32_t cell) { return &city.cells.corners[3 * cell]; };
  std::uint64_t pairs = 0;
  for (std::uint32_t a = 0; a < city.cells.count(); ++a) {
    for (std::uint32_t b = 0; b < city.cells.count(); ++b) {
      int shared = 0;
      for (int i = 0; i < 3; ++i) shared += std::count(corners(b), corners(b) + 3, corners(a)[i]) == 1;
      ASSERT_EQ(neighbours.contains(a, b), shared == 2) << a << ' ' << b;
      pairs += shared == 2;
    }
  }
  // Every side but those of 64 boxes and of the ground is shared.
  EXPECT_EQ(pairs, 3u * city.cells.count() - 4 * 64 - 4);
}

TEST(City, StreetsStayFree) {
  CityOptions options = of_size(8);
  options.jitter = 1;
  options.narrowest_street = 6;
  const std::vector<Box> boxes = object_bounds(make_city(options).scene);
  for (std::size_t a = 0; a < boxes.size(); ++a) {
    for (std::size_t b = 0; b < a; ++b) {
      float gap = -std::numeric_limits<float>::infinity();
      for (int axis = 0; axis < 2; ++axis) {
        gap = std::max(
            {gap, boxes[a].low[axis] - boxes[b].high[axis], boxes[b].low[axis] - boxes[a].high[axis]});
      }
      ASSERT_GE(gap, options.narrowest_street - 1e-4f) << a << ' ' << b;
    }
  }
}

TEST(City, SidesAndHeightsAreAsAsked) {
  const CityOptions options = of_size(16);
  for (const Box& box : object_bounds(make_city(options).scene)) {
    for (int axis = 0; axis < 2; ++axis) {
      EXPECT_GE(box.high[axis] - box.low[axis], options.smallest_side - 1e-3f);
      EXPECT_LE(box.high[axis] - box.low[axis], options.largest_side + 1e-3f);
    }
    EXPECT_EQ(box.low[2], 0);
    EXPECT_GE(box.high[2], options.lowest);
    EXPECT_LE(box.high[2], options.highest);
  }
}

TEST(City, SeedDecides) {
  CityOptions options = of_size(4);
  const SceneFile once = make_city(options), again = make_city(options);
  EXPECT_EQ(once.scene.vertices, again.scene.vertices);
  EXPECT_EQ(once.cells.corners, again.cells.corners);
  EXPECT_EQ(once.seed, options.seed);
  options.seed = 2;
  EXPECT_NE(make_city(options).scene.vertices, once.scene.vertices);
  EXPECT_NE(describe(options), describe(of_size(4)));
}

TEST(City, RefusesWhatCannotBeBuilt) {
  const auto refused = [](auto change) {
    CityOptions options;
    change(options);
    EXPECT_THROW(make_city(options), std::invalid_argument);
  };
  refused([](CityOptions& o) { o.size = 0; });
  refused([](CityOptions& o) { o.size = 33; });
  refused([](CityOptions& o) { o.size = 1u << 31; });
  refused([](CityOptions& o) { o.largest_side = o.pitch; });
  refused([](CityOptions& o) { o.smallest_side = o.largest_side + 1; });
  refused([](CityOptions& o) { o.smallest_side = 0; });
  refused([](CityOptions& o) { o.pitch = std::numeric_limits<float>::quiet_NaN(); });
  refused([](CityOptions& o) { o.highest = std::numeric_limits<float>::infinity(); });
  refused([](CityOptions& o) { o.highest = o.lowest - 1; });
  refused([](CityOptions& o) { o.jitter = 1.5f; });
  refused([](CityOptions& o) { o.eye_high = o.eye_low / 2; });
}

}  // namespace
}  // namespace vismat
