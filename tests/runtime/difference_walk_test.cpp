#include "runtime/difference_walk.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/matrix/neighbouring_cells.h"
#include "tests/refusal.h"

namespace vismat {
namespace {

TEST(DifferenceWalk, SeesEachCellsRowOnAnyWay) {
  Random random(3);
  std::size_t returns = 0;
  for (const Case& c : random_cases()) {
    const Deltas deltas = deltas_of(c.cells, c.neighbours);
    DifferenceWalk walk(deltas);
    EXPECT_EQ(walk.cell(), outside);
    EXPECT_TRUE(walk.visible().empty());
    for (int step = 0; step < 3000 && !deltas.boundaries.empty(); ++step) {
      const auto near = walk.map().neighbours(walk.cell());
      const std::uint32_t to = near[random.below(static_cast<std::uint32_t>(near.size()))];
      const std::uint32_t from = walk.cell();
      EXPECT_EQ(walk.go(to).boundary, walk.map().crossing(from, to)->boundary);
      ASSERT_EQ(walk.cell(), to);
      ASSERT_TRUE(to == outside ? walk.visible().empty()
                                : std::ranges::equal(walk.visible(), c.cells.row(to)));
      returns += to == outside;
    }
  }
  EXPECT_GT(returns, 1000u);
}

TEST(DifferenceWalk, StaysWhereItIsIfNoBoundaryLeadsOn) {
  const auto cells = VisibilityMatrix::from_rows({{0, 1}, {1, 2}, {5}}, 6);
  Deltas deltas = deltas_of(cells, symmetric(3, {{0, 1}}));
  DifferenceWalk walk(deltas);
  EXPECT_EQ(test::refusal<std::invalid_argument>([&] { walk.go(1); }),
            "no boundary leads from outside to cell 1");
  walk.go(0);
  EXPECT_EQ(test::refusal<std::invalid_argument>([&] { walk.go(2); }),
            "no boundary leads from cell 0 to cell 2");
  EXPECT_EQ(test::refusal<std::invalid_argument>([&] { walk.go(0); }),
            "no boundary leads from cell 0 to cell 0");
  EXPECT_EQ(test::refusal<std::invalid_argument>([&] { walk.go(77); }),
            "no boundary leads from cell 0 to cell 77");
  EXPECT_TRUE(std::ranges::equal(walk.visible(), cells.row(0)));

  deltas.lists = VisibilityMatrix::from_rows({{0, 1}, {}, {5}, {}, {1}, {}}, 6);
  DifferenceWalk damaged(deltas);
  damaged.go(0);
  EXPECT_EQ(test::refusal<std::invalid_argument>([&] { damaged.go(1); }),
            "column 1 appears, but was visible before");
  EXPECT_EQ(damaged.cell(), 0u);
  EXPECT_TRUE(std::ranges::equal(damaged.visible(), cells.row(0)));
  deltas.lists = VisibilityMatrix({4, 6});
  EXPECT_EQ(test::refusal<std::invalid_argument>([&] { DifferenceWalk short_of_lists(deltas); }),
            "3 boundaries, but 4 lists; each has two");
}

TEST(DifferenceWalk, NamesTheCrossingsOfAWayAndRefusesAWrongRow) {
  const auto cells = VisibilityMatrix::from_rows({{0, 1}, {1, 2}, {5}}, 6);
  const Deltas deltas = deltas_of(cells, symmetric(3, {{0, 1}, {1, 2}}));
  const std::vector<std::uint32_t> way = {1, 2, 1, 0};
  const auto crossings = crossings_of(deltas, cells, way);
  ASSERT_EQ(crossings.size(), 3u);
  const BoundaryMap map(deltas.boundaries);
  for (std::size_t i = 0; i < crossings.size(); ++i) {
    EXPECT_EQ(crossings[i].boundary, map.crossing(way[i], way[i + 1])->boundary);
    EXPECT_EQ(crossings[i].back, way[i] > way[i + 1]);
  }
  EXPECT_TRUE(crossings_of(deltas, cells, {}).empty());
  const auto other = VisibilityMatrix::from_rows({{0, 1}, {1, 2}, {4}}, 6);
  EXPECT_THROW(crossings_of(deltas, other, way), std::logic_error);
}

}  // namespace
}  // namespace vismat
