// Every order in the table, on every matrix.
#include "layout/reordering.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "layout/bisection.h"
#include "layout/cost.h"
#include "layout/distinct_columns.h"
#include "layout/lexicographic_order.h"
#include "layout/morton_order.h"
#include "layout/random_order.h"
#include "tests/codecs/matrices.h"

namespace vismat {
namespace {

VisibilityMatrix reordered(const VisibilityMatrix& m, const Permutation& columns) {
  return permute(m, Permutation::identity(m.shape().rows), columns);
}

class EveryReordering : public testing::TestWithParam<Reordering> {};

TEST_P(EveryReordering, IsABijectionThatItsInverseUndoesWhateverTheThreads) {
  for (const auto& m : test::assorted_matrices()) {
    const std::vector<Box> boxes(m.matrix.shape().columns);
    ReorderingOptions options{.column_bounds = boxes, .threads = 1};
    const Permutation order = GetParam().order_columns(m.matrix, options);
    ASSERT_EQ(order.size(), m.matrix.shape().columns) << m.name;
    EXPECT_EQ(reordered(reordered(m.matrix, order), order.inverse()), m.matrix) << m.name;
    if (GetParam().name == "flann-tour") continue;  // FLANN takes its seeds from the system
    options.threads = 2;
    EXPECT_EQ(GetParam().order_columns(m.matrix, options), order) << m.name;
  }
}

INSTANTIATE_TEST_SUITE_P(Table, EveryReordering,
                         testing::ValuesIn(reorderings().begin(), reorderings().end()),
                         [](const testing::TestParamInfo<Reordering>& method) {
                           std::string name(method.param.name);
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

// Columns see a sliding window of rows; shuffled, the planted order has by far the fewest runs.
class PlantedOrder : public testing::TestWithParam<std::pair<const char*, double>> {};

TEST_P(PlantedOrder, ComesBackNearItsCost) {
  std::vector<std::vector<std::uint32_t>> rows(330);
  const Permutation shuffle = random_order(300, 5);
  for (std::uint32_t c = 0; c < 300; ++c) {
    for (std::uint32_t r = c; r < c + 30; ++r) rows[r].push_back(shuffle.new_of_old()[c]);
  }
  for (auto& row : rows) std::sort(row.begin(), row.end());
  const auto m = VisibilityMatrix::from_rows(rows, 300);
  const std::uint64_t planted = count_runs(reordered(m, shuffle.inverse()));
  ASSERT_EQ(planted, 329u);
  const auto found = count_runs(reordered(m, find_reordering(GetParam().first).order_columns(m, {})));
  EXPECT_LE(static_cast<double>(found), GetParam().second * static_cast<double>(planted));
}

INSTANTIATE_TEST_SUITE_P(Methods, PlantedOrder,
                         testing::Values(std::pair("polished-tour", 1.), std::pair("best", 1.),
                                         std::pair("exact-tour", 1.2), std::pair("greedy", 2.),
                                         std::pair("lexicographic", 1.), std::pair("bisection", 5.)),
                         [](const auto& method) { return "order_" + std::to_string(method.index); });

TEST(Best, IsNeverWorseThanIdentity) {
  for (const auto& m : test::assorted_matrices()) {
    EXPECT_LE(count_runs(reordered(m.matrix, find_reordering("best").order_columns(m.matrix, {}))),
              count_runs(m.matrix))
        << m.name;
  }
}

TEST(DistinctColumns, CollapseAndUnfold) {
  const auto m = VisibilityMatrix::from_rows({{0, 2, 3}, {1, 3}, {0, 2}}, 5);
  const DistinctColumns d = distinct_columns(m);
  EXPECT_EQ(d.distinct_of_column, (std::vector<std::uint32_t>{0, 1, 0, 2, 3}));
  EXPECT_EQ(d.matrix, VisibilityMatrix::from_rows({{0, 2}, {1, 2}, {0}}, 4));
  const auto order = unfold(Permutation::from_old_of_new({3, 0, 2, 1}), d.distinct_of_column);
  EXPECT_EQ(order.old_of_new(), (std::vector<std::uint32_t>{4, 0, 2, 3, 1}));
}

TEST(Lexicographic, SortsBitStringsWithOnesFirst) {
  const auto m = VisibilityMatrix::from_rows({{2, 4}, {0, 2}, {1, 4}}, 5);  // columns 010, 001, 110, 000, 101
  EXPECT_EQ(lexicographic_order(m).old_of_new(), (std::vector<std::uint32_t>{2, 4, 0, 1, 3}));
}

TEST(Morton, FollowsTheCurve) {
  std::vector<Box> boxes;
  for (const auto& [x, y] : {std::pair{3.f, 3.f}, {0.f, 0.f}, {3.f, 0.f}, {0.f, 3.f}})
    boxes.push_back({{x, y, 0}, {x, y, 0}});
  EXPECT_EQ(morton_order(boxes).old_of_new(), (std::vector<std::uint32_t>{1, 2, 3, 0}));
  EXPECT_EQ(morton_order(std::vector<Box>{}).size(), 0u);
}

TEST(Random, TakesEveryOrderAlikeAndTheSeedAlone) {
  std::map<std::vector<std::uint32_t>, int> times;
  for (std::uint64_t seed = 0; seed < 6000; ++seed) ++times[random_order(3, seed).old_of_new()];
  ASSERT_EQ(times.size(), 6u);
  for (const auto& [order, count] : times) EXPECT_NEAR(count, 1000, 150);
  EXPECT_EQ(random_order(50, 7), random_order(50, 7));
}

TEST(FindReordering, ListsTheNames) {
  try {
    find_reordering("sorted");
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("polished-tour"), std::string::npos);
  }
}

}  // namespace
}  // namespace vismat
