#include "visibility/geometry/touching_boxes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "matrix/base/random.h"

namespace vismat {
namespace {

// Cells of an octree in units that floats hold exactly, split at random.
void add_octree(std::vector<Box>& boxes, Random& random, std::array<float, 3> low, float size,
                int dimensions) {
  if (size > 1 && random.below(3) > 0) {
    for (int child = 0; child < 1 << dimensions; ++child) {
      std::array<float, 3> corner = low;
      for (int axis = 0; axis < dimensions; ++axis) corner[axis] += child >> axis & 1 ? size / 2 : 0;
      add_octree(boxes, random, corner, size / 2, dimensions);
    }
    return;
  }
  Box box{low, low};
  for (int axis = 0; axis < dimensions; ++axis) box.high[axis] += size;
  boxes.push_back(box);
}

// By counting the unit cubes (squares where all is flat) that lie in one box and across a face from the other.
bool share_unit_faces(const Box& a, const Box& b, int dimensions) {
  for (int axis = 0; axis < dimensions; ++axis) {
    if (a.high[axis] != b.low[axis] && b.high[axis] != a.low[axis]) continue;
    int common = 1;
    for (int other = 0; other < dimensions; ++other) {
      if (other == axis) continue;
      int units = 0;
      for (float at = 0; at < 16; ++at)
        units += at >= a.low[other] && at < a.high[other] && at >= b.low[other] && at < b.high[other];
      common *= units;
    }
    if (common > 0) return true;
  }
  return false;
}

TEST(TouchingBoxes, AgreesWithUnitFacesOnOctrees) {
  Random random(4);
  std::uint64_t found = 0;
  for (int i = 0; i < 40; ++i) {
    const int dimensions = 2 + i % 2;
    std::vector<Box> boxes;
    add_octree(boxes, random, {0, 0, 0}, 16, dimensions);
    for (std::size_t b = boxes.size(); b > 1; --b)
      std::swap(boxes[b - 1], boxes[random.below(static_cast<std::uint32_t>(b))]);
    if (boxes.size() > 700) boxes.resize(700);  // holes
    const VisibilityMatrix neighbours = touching_boxes(boxes);
    const auto count = static_cast<std::uint32_t>(boxes.size());
    ASSERT_EQ(neighbours.shape(), (Shape{count, count}));
    for (std::uint32_t a = 0; a < count; ++a) {
      for (std::uint32_t b = 0; b < count; ++b)
        ASSERT_EQ(neighbours.contains(a, b), a != b && share_unit_faces(boxes[a], boxes[b], dimensions));
    }
    found += neighbours.ones();
  }
  EXPECT_GT(found, 1000u);
}

TEST(TouchingBoxes, EdgesAndCornersAreNoFaces) {
  std::vector<Box> grid;  // 3 x 3 x 3
  for (float x : {0.f, 1.f, 2.f}) {
    for (float y : {0.f, 1.f, 2.f}) {
      for (float z : {0.f, 1.f, 2.f}) grid.push_back({{x, y, z}, {x + 1, y + 1, z + 1}});
    }
  }
  const VisibilityMatrix neighbours = touching_boxes(grid);
  EXPECT_EQ(neighbours.ones(), 2u * 54);
  EXPECT_TRUE(std::ranges::equal(neighbours.row(13), std::vector<std::uint32_t>{4, 10, 12, 14, 16, 22}));
}

TEST(TouchingBoxes, TakesFlatAndOverlappingBoxes) {
  const auto touch = [](const Box& a, const Box& b) {
    const Box both[] = {a, b};
    const VisibilityMatrix neighbours = touching_boxes(both);
    EXPECT_EQ(neighbours, transpose(neighbours));
    return neighbours.ones() == 2;
  };
  const Box square{{0, 0, 0}, {1, 1, 0}}, cube{{0, 0, 0}, {1, 1, 1}}, point{{0, 0, 0}, {0, 0, 0}};
  EXPECT_TRUE(touch(square, {{1, 0, 0}, {2, 1, 0}}));
  EXPECT_FALSE(touch(square, {{1, 1, 0}, {2, 2, 0}}));  // a corner
  EXPECT_FALSE(touch(square, {{1, 0, 1}, {2, 1, 1}}));  // another floor
  EXPECT_FALSE(touch(square, {{0, 0, 1}, {1, 1, 1}}));
  EXPECT_TRUE(touch(square, {{0, 0, -1}, {1, 1, 0}}));   // on a cube's top
  EXPECT_FALSE(touch(square, {{1, 0, -1}, {2, 1, 0}}));  // beside it: an edge
  EXPECT_TRUE(touch(cube, {{.5, .5, .5}, {2, 2, 2}}));
  EXPECT_TRUE(touch(cube, {{.25, .25, .25}, {.5, .5, .5}}));
  EXPECT_TRUE(touch(cube, cube));
  EXPECT_FALSE(touch(cube, {{1, 1, 0}, {2, 2, 1}}));  // an edge
  EXPECT_FALSE(touch(cube, {{1.5, 0, 0}, {2, 1, 1}}));
  EXPECT_FALSE(touch(point, point));
  EXPECT_FALSE(touch(point, cube));
  EXPECT_EQ(touching_boxes({}).shape(), (Shape{0, 0}));
}

}  // namespace
}  // namespace vismat
