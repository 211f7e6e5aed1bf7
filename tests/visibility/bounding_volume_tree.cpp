#include "visibility/geometry/bounding_volume_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <stdexcept>

#include "matrix/base/random.h"

namespace vismat {
namespace {

std::vector<Box> random_boxes(std::uint32_t count, std::uint64_t seed) {
  Random random(seed);
  std::vector<Box> boxes(count);
  for (Box& box : boxes) {
    for (std::size_t k = 0; k < 3; ++k) {
      box.low[k] = random.between(0, 100);
      box.high[k] = box.low[k] + random.unit();
    }
  }
  return boxes;
}

TEST(BoundingVolumeTree, HoldsEachObjectOnceUnderFullNodes) {
  for (const unsigned arity : {2u, 3u, 4u, 8u}) {
    for (std::uint32_t count = 1; count < 130; ++count) {
      const ObjectTree tree = bounding_volume_tree(random_boxes(count, count), arity);
      std::vector<int> seen(count, 0);
      std::uint32_t inner = 0, short_nodes = 0;
      for (std::uint32_t node = 0; node < tree.size(); ++node) {
        const auto children = tree.children(node).size();
        const auto object = tree.object_of_node()[node];
        EXPECT_EQ(children == 0, object != ObjectTree::none);
        if (object != ObjectTree::none) ++seen[object];
        if (children == 0) continue;
        ++inner;
        EXPECT_GE(children, 2u);
        EXPECT_LE(children, arity);
        short_nodes += children < arity;
      }
      EXPECT_EQ(std::count(seen.begin(), seen.end(), 1), count);
      EXPECT_LE(short_nodes, 1u) << count << " objects, arity " << arity;
      EXPECT_EQ(inner, (count - 1 + arity - 2) / (arity - 1));  // no tree has fewer
    }
  }
}

TEST(BoundingVolumeTree, OfAGridIsItsQuadtree) {
  std::vector<Box> boxes;
  for (const float y : {0.f, 1.f, 2.f, 3.f}) {
    for (const float x : {0.f, 1.f, 2.f, 3.f}) boxes.push_back({{x, y, 0}, {x + 0.5f, y + 0.5f, 1}});
  }
  const ObjectTree tree = bounding_volume_tree(boxes);
  ASSERT_EQ(tree.size(), 21u);
  std::vector<std::vector<std::uint32_t>> quarters;
  for (const std::uint32_t child : tree.children(0)) {
    quarters.emplace_back();
    for (const std::uint32_t leaf : tree.children(child))
      quarters.back().push_back(tree.object_of_node()[leaf]);
    std::sort(quarters.back().begin(), quarters.back().end());
  }
  std::sort(quarters.begin(), quarters.end());
  EXPECT_EQ(quarters, (std::vector<std::vector<std::uint32_t>>{
                          {0, 1, 4, 5}, {2, 3, 6, 7}, {8, 9, 12, 13}, {10, 11, 14, 15}}));
}

TEST(BoundingVolumeTree, NumbersNodesBreadthFirst) {
  const ObjectTree tree = bounding_volume_tree(random_boxes(777, 5));
  EXPECT_TRUE(std::is_sorted(tree.parent_of_node().begin() + 1, tree.parent_of_node().end()));
}

TEST(BoundingVolumeTree, OfBoxesInOnePlaceIsStillDetermined) {
  const std::vector<Box> boxes(100, Box{{1, 1, 1}, {2, 2, 2}});
  EXPECT_EQ(bounding_volume_tree(boxes), bounding_volume_tree(boxes));
  EXPECT_EQ(bounding_volume_tree(boxes).size(), 133u);
}

TEST(BoundingVolumeTree, OfNothingAndOfOne) {
  EXPECT_EQ(bounding_volume_tree({}).size(), 0u);
  EXPECT_EQ(bounding_volume_tree(random_boxes(1, 1)), ObjectTree::from_parents({ObjectTree::none}, {0}, 1));
}

TEST(BoundingVolumeTree, TakesTheLargestFloats) {
  const float far = std::numeric_limits<float>::max();
  const std::vector<Box> boxes = {
      {{-far, 0, 0}, {-far, 0, 0}}, {{far, 0, 0}, {far, 0, 0}}, {{-far, -far, -far}, {far, far, far}}};
  EXPECT_EQ(bounding_volume_tree(boxes).size(), 4u);
}

TEST(BoundingVolumeTree, RefusesWhatHasNoPlace) {
  std::vector<Box> boxes = random_boxes(3, 1);
  boxes[1].high[2] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(bounding_volume_tree(boxes), std::invalid_argument);
  boxes[1].high[2] = std::numeric_limits<float>::infinity();
  EXPECT_THROW(bounding_volume_tree(boxes), std::invalid_argument);
  EXPECT_THROW(bounding_volume_tree(random_boxes(3, 1), 1), std::invalid_argument);
}

}  // namespace
}  // namespace vismat
