#include "runtime/level_walk.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace vismat {
namespace {

using Ids = std::vector<std::uint32_t>;

// Cells 1 to 4 stand round a way of four passages; 0 and 5 stand alone.
const VisibilityMatrix passages = VisibilityMatrix::from_rows({{}, {2, 4}, {1, 3}, {2, 4}, {1, 3}, {}}, 6);
const std::vector<Box> boxes = {
    {}, {{0, 0, 0}, {0, 0, 0}}, {{3, 0, 0}, {3, 0, 0}}, {{3, 1, 0}, {3, 1, 0}}, {{-1, -1, 0}, {1, 2, 0}}, {}};

TEST(LevelWalk, FindsTheLargestPartAndTheShortestWay) {
  EXPECT_EQ(largest_part(passages), (Ids{1, 2, 4, 3}));
  EXPECT_EQ(shortest_way(passages, boxes, 1, 3), (Ids{4, 3}));  // 0.5 + 3.04 m; by cell 2 it is 3 + 1 m
  EXPECT_EQ(shortest_way(passages, boxes, 2, 2), Ids{});
}

TEST(LevelWalk, GoesByPassagesAlone) {
  const Ids walk = walk_cells(passages, boxes, 500, 7);
  ASSERT_EQ(walk.size(), 501u);
  Ids visits(6);
  for (std::size_t i = 0; i < walk.size(); ++i) {
    ++visits[walk[i]];
    if (i == 0) continue;
    EXPECT_TRUE(passages.contains(walk[i - 1], walk[i])) << i;
  }
  EXPECT_EQ(visits[0] + visits[5], 0u);
  for (const std::uint32_t cell : {1, 2, 3, 4}) EXPECT_GT(visits[cell], 50u);
  EXPECT_EQ(walk, walk_cells(passages, boxes, 500, 7));
  EXPECT_NE(walk, walk_cells(passages, boxes, 500, 8));
  EXPECT_THROW(walk_cells(VisibilityMatrix({3, 3}), boxes, 5, 1), std::invalid_argument);
}

TEST(LevelWalk, PassagesLeadWhereCellsTouchAndSeeOneAnother) {
  Level level;
  level.cells = VisibilityMatrix::from_rows({{0, 1, 2}, {0, 1}, {2}}, 3);
  level.cell_neighbours = VisibilityMatrix::from_rows({{1, 2}, {0}, {0}}, 3);
  EXPECT_EQ(passages_of(level), VisibilityMatrix::from_rows({{1}, {0}, {}}, 3));
}

}  // namespace
}  // namespace vismat
