#include "matrix/deltas.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include "matrix/base/random.h"
#include "tests/matrix/neighbouring_cells.h"
#include "tests/refusal.h"

namespace vismat {
namespace {

TEST(Deltas, ListWhatAppearsAndWhatVanishes) {
  const auto cells = VisibilityMatrix::from_rows({{0, 1}, {1, 2, 3}, {5}, {1, 2, 3}}, 6);
  const Deltas deltas = deltas_of(cells, symmetric(4, {{0, 1}, {1, 3}, {0, 3}, {2, 2}}));
  EXPECT_EQ(deltas.boundaries, (std::vector<Boundary>{{outside, 0}, {outside, 2}, {0, 1}, {0, 3}, {1, 3}}));
  EXPECT_EQ(deltas.lists,
            VisibilityMatrix::from_rows({{0, 1}, {}, {5}, {}, {2, 3}, {0}, {2, 3}, {0}, {}, {}}, 6));
}

TEST(Deltas, LeadBackToTheCells) {
  for (const Case& c : random_cases()) {
    const Deltas deltas = deltas_of(c.cells, c.neighbours);
    EXPECT_EQ(deltas.lists.shape().rows, 2 * deltas.boundaries.size());
    const VisibilityMatrix back = cells_of(deltas);
    EXPECT_EQ(back, c.cells);
    EXPECT_EQ(deltas_of(back, neighbours_of(deltas.boundaries)), deltas);
  }
}

TEST(Deltas, RefuseNeighboursThatAreNone) {
  const VisibilityMatrix cells({3, 4});
  EXPECT_EQ(test::refusal<std::invalid_argument>([&] { deltas_of(cells, symmetric(3, {{0, 1}})); }), "");
  EXPECT_EQ(test::refusal<std::invalid_argument>([&] {
              deltas_of(cells, VisibilityMatrix({3, 4}));
            }),
            "the neighbours are 3 x 4, but there are 3 cells");
  EXPECT_EQ(test::refusal<std::invalid_argument>([&] {
              deltas_of(cells, VisibilityMatrix::from_rows({{}, {2}, {}}, 3));
            }),
            "cell 1 and its neighbours do not name one another");
}

TEST(Deltas, RefuseListsThatContradictOneAnother) {
  const auto cells = VisibilityMatrix::from_rows({{0, 1}, {1, 2}, {2, 4}}, 6);
  const Deltas good = deltas_of(cells, symmetric(3, {{0, 1}, {1, 2}, {0, 2}}));
  EXPECT_EQ(cells_of(good), cells);
  const auto changed = [&](std::uint32_t list, std::vector<std::uint32_t> ids) {
    Rows rows;
    for (std::uint32_t r = 0; r < good.lists.shape().rows; ++r)
      rows.emplace_back(good.lists.row(r).begin(), good.lists.row(r).end());
    rows[list] = std::move(ids);
    return test::refusal<std::invalid_argument>([&] {
      cells_of({good.boundaries, VisibilityMatrix::from_rows(rows, 6)});
    });
  };
  EXPECT_EQ(changed(2, {1, 2}), "boundary 1, cell 0 to cell 1: column 1 appears, but was visible before");
  EXPECT_EQ(changed(3, {0, 5}), "boundary 1, cell 0 to cell 1: column 5 vanishes, but was not visible");
  EXPECT_EQ(changed(3, {0, 1, 3, 4, 5}), "boundary 1, cell 0 to cell 1: more vanishes than was visible");
  EXPECT_EQ(changed(2, {2, 3}), "boundary 3, cell 1 to cell 2: another way leads to other ids visible there");
  EXPECT_EQ(test::refusal<std::invalid_argument>([&] {
              cells_of({good.boundaries, VisibilityMatrix({6, 6})});
            }),
            "4 boundaries, but 6 lists; each has two");
}

TEST(BoundaryMap, RefusesWhatIsNotInOrderOrDoesNotReachEachCell) {
  const auto of = [](std::vector<Boundary> boundaries) {
    return test::refusal<std::invalid_argument>([&] { BoundaryMap map(boundaries); });
  };
  EXPECT_EQ(of({}), "");
  EXPECT_EQ(of({{outside, 0}, {outside, 2}, {0, 1}, {2, 3}}), "");
  EXPECT_NE(of({{outside, 0}, {0, 1}, {outside, 2}}).find("boundary 2, outside to cell 2: must come before"),
            std::string::npos);
  EXPECT_NE(of({{outside, 0}, {0, 2}, {0, 1}}).find("boundary 2"), std::string::npos);
  EXPECT_NE(of({{outside, 0}, {0, 1}, {0, 1}}).find("boundary 2"), std::string::npos);
  EXPECT_NE(of({{outside, 0}, {1, 0}}).find("boundary 1, cell 1 to cell 0: leads down"), std::string::npos);
  EXPECT_NE(of({{outside, 0}, {1, 1}}).find("leads down"), std::string::npos);
  EXPECT_NE(of({{outside, 0}, {outside, outside}}).find("no more than 2 cells"), std::string::npos);
  EXPECT_NE(of({{outside, 4}}).find("no more than 1 cells"), std::string::npos);
  EXPECT_NE(
      of({{outside, 0}, {outside, 1}, {0, 1}}).find("boundary 1, outside to cell 1: that part is entered"),
      std::string::npos);
  EXPECT_NE(of({{outside, 1}, {0, 1}}).find("least cell, 0"), std::string::npos);
  EXPECT_EQ(of({{outside, 0}, {1, 2}, {1, 3}, {2, 3}}), "no boundaries lead from outside to cell 1");
}

TEST(BoundaryMap, FindsEachBoundaryFromBothSides) {
  for (const Case& c : random_cases()) {
    const Deltas deltas = deltas_of(c.cells, c.neighbours);
    const BoundaryMap map(deltas.boundaries);
    EXPECT_EQ(map.cells(), c.cells.shape().rows);
    for (std::uint32_t a = 0; a <= map.cells(); ++a) {  // one more than there are
      for (std::uint32_t b = 0; b <= map.cells(); ++b) {
        const auto found = std::ranges::find(deltas.boundaries, Boundary{std::min(a, b), std::max(a, b)});
        const auto crossing = map.crossing(a, b);
        ASSERT_EQ(crossing.has_value(), found != deltas.boundaries.end());
        if (!crossing) continue;
        EXPECT_EQ(crossing->boundary, found - deltas.boundaries.begin());
        EXPECT_EQ(crossing->appears(), 2 * crossing->boundary + (a > b));
        EXPECT_EQ(crossing->vanishes(), 2 * crossing->boundary + (a < b));
      }
      if (a == map.cells()) break;
      EXPECT_TRUE(std::ranges::is_sorted(map.neighbours(a)));
      EXPECT_EQ(map.crossing(outside, a).has_value(), map.crossing(a, outside).has_value());
    }
  }
}

TEST(Cross, MergesLikeSets) {
  Random random(2);
  std::vector<std::uint32_t> result(4000);
  for (int i = 0; i < 2000; ++i) {
    const std::uint32_t columns = 1 + random.below(1000);
    const auto rows = random_cells({2, columns}, random);
    const auto before = rows.row(0), after = rows.row(1);
    std::vector<std::uint32_t> appears, vanishes;
    std::ranges::set_difference(after, before, std::back_inserter(appears));
    std::ranges::set_difference(before, after, std::back_inserter(vanishes));
    const std::size_t count = cross(before, appears, vanishes, result);
    ASSERT_TRUE(std::ranges::equal(std::span(result).first(count), after));
  }
}

TEST(Cross, NamesTheColumnThatDoesNotFit) {
  using Ids = std::vector<std::uint32_t>;
  const auto of = [](const Ids& visible, const Ids& appears, const Ids& vanishes) {
    return test::refusal<std::invalid_argument>([&] {
      Ids result(visible.size() + appears.size());
      cross(visible, appears, vanishes, result);
    });
  };
  EXPECT_EQ(of({1, 4, 9}, {2, 10}, {1, 9}), "");
  EXPECT_EQ(of({1, 4, 9}, {4}, {}), "column 4 appears, but was visible before");
  EXPECT_EQ(of({1, 4, 9}, {}, {5}), "column 5 vanishes, but was not visible");
  EXPECT_EQ(of({1, 4, 9}, {}, {4, 10, 11, 12}), "column 10 vanishes, but was not visible");
  EXPECT_EQ(of({}, {}, {0}), "column 0 vanishes, but was not visible");
  EXPECT_EQ(of({1}, {3}, {3}), "column 3 vanishes, but was not visible");
  EXPECT_EQ(of({1}, {1}, {1}), "column 1 appears, but was visible before");
}

}  // namespace
}  // namespace vismat
