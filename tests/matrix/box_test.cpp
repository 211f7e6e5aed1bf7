#include "matrix/box.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <vector>

#include "matrix/base/random.h"
#include "matrix/base/union_find.h"
#include "matrix/base/z_order.h"
#include "matrix/object_tree.h"

namespace vismat {
namespace {

TEST(Box, GrowsFromNothing) {
  Box box = empty_box;
  EXPECT_EQ(zero_if_empty(box), Box{});
  grow(box, std::array<float, 3>{1, -2, 3});
  EXPECT_EQ(box, (Box{{1, -2, 3}, {1, -2, 3}}));
  EXPECT_EQ(zero_if_empty(box), box);
  grow(box, std::array<float, 3>{0, 5, 3});
  EXPECT_EQ(box, (Box{{0, -2, 3}, {1, 5, 3}}));
  EXPECT_EQ(box_around(box, {{-1, 0, 0}, {0.5f, 1, 9}}), (Box{{-1, -2, 0}, {1, 5, 9}}));
  EXPECT_EQ(box_around(empty_box, box), box);
  EXPECT_EQ(box_around(box, empty_box), box);
}

TEST(Box, HasACentreThatDoesNotOverflow) {
  constexpr float most = std::numeric_limits<float>::max();
  EXPECT_EQ(centre_of({{0, -4, most}, {1, 2, most}}), (std::array<float, 3>{0.5f, -1, most}));
}

TEST(Box, MeetsWhatItTouches) {
  const Box box = {{0, 0, 0}, {1, 1, 1}};
  EXPECT_TRUE(meet(box, {{1, 1, 1}, {2, 2, 2}}));
  EXPECT_TRUE(meet({{0.2f, 0.2f, 0.2f}, {0.3f, 0.3f, 0.3f}}, box));
  for (int axis = 0; axis < 3; ++axis) {
    Box away = box;
    away.low[axis] = 1.5f, away.high[axis] = 2;
    EXPECT_FALSE(meet(box, away));
    EXPECT_FALSE(meet(away, box));
  }
  EXPECT_FALSE(meet(box, empty_box));
}

TEST(NodeBounds, AreAroundTheObjectsBelow) {
  // 0: 1 2; 1: object 2; 2: 3 4; 3: object 0; 4: nothing
  const ObjectTree tree = ObjectTree::from_parents(
      {ObjectTree::none, 0, 0, 2, 2}, {ObjectTree::none, 2, ObjectTree::none, 0, ObjectTree::none}, 3);
  const std::vector<Box> boxes = {{{0, 0, 0}, {1, 1, 1}}, {{-9, 0, 0}, {9, 0, 0}}, {{2, 2, 2}, {3, 3, 3}}};
  EXPECT_EQ(node_bounds(tree, boxes),
            (std::vector<Box>{{{0, 0, 0}, {3, 3, 3}}, boxes[2], boxes[0], boxes[0], Box{}}));
}

TEST(UnionFind, NamesSetsByTheirLeastPoint) {
  Random random(1);
  constexpr std::uint32_t size = 200;
  UnionFind sets(size);
  std::vector<std::uint32_t> least(size);  // the slow way
  for (std::uint32_t i = 0; i < size; ++i) least[i] = i;
  for (int joins = 0; joins < 150; ++joins) {
    const std::uint32_t a = random.below(size), b = random.below(size);
    sets.join_sets(a, b);
    const std::uint32_t from = std::max(least[a], least[b]), to = std::min(least[a], least[b]);
    for (std::uint32_t& root : least) {
      if (root == from) root = to;
    }
    for (std::uint32_t i = 0; i < size; ++i) ASSERT_EQ(sets.find(i), least[i]);
  }
}

TEST(ZOrder, InterleavesBits) {
  Random random(2);
  for (int i = 0; i < 1000; ++i) {
    const auto x = static_cast<std::uint32_t>(random.next()), y = static_cast<std::uint32_t>(random.next()),
               z = static_cast<std::uint32_t>(random.next());
    std::uint64_t two = 0, three = 0;
    for (unsigned bit = 0; bit < 32; ++bit)
      two |= std::uint64_t{x >> bit & 1} << 2 * bit | std::uint64_t{y >> bit & 1} << (2 * bit + 1);
    for (unsigned bit = 0; bit < 21; ++bit) {
      three |=
          (std::uint64_t{x >> bit & 1} | std::uint64_t{y >> bit & 1} << 1 | std::uint64_t{z >> bit & 1} << 2)
          << 3 * bit;
    }
    ASSERT_EQ(z_order(x, y), two);
    ASSERT_EQ(z_order(x, y, z), three);
  }
}

}  // namespace
}  // namespace vismat
