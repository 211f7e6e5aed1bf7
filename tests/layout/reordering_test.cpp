// Tests every order in the table, on every matrix.
#include "layout/reordering.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "layout/cost.h"
#include "layout/orders/random_order.h"
#include "tests/codecs/matrices.h"
#include "tests/table_name.h"

namespace vismat {
namespace {

VisibilityMatrix reordered(const VisibilityMatrix& m, const Permutation& columns) {
  return permute(m, Permutation::identity(m.shape().rows), columns);
}

// The assorted ones, and what has nothing to order by.
std::vector<test::NamedMatrix> matrices() {
  std::vector<test::NamedMatrix> all = test::assorted_matrices(true);
  all.push_back({"one column", test::random_matrix({50, 1}, .5, 1)});
  all.push_back({"one row", test::random_matrix({1, 50}, .5, 1)});
  std::vector<std::vector<std::uint32_t>> alternating(20), equal(20);
  for (std::uint32_t r = 0; r < 20; ++r) {
    for (std::uint32_t c = 0; c < 90; c += 2) alternating[r].push_back(c);
    for (std::uint32_t c = 0; r % 3 == 0 && c < 90; ++c) equal[r].push_back(c);
  }
  all.push_back({"zero and full columns", VisibilityMatrix::from_rows(alternating, 90)});
  all.push_back({"equal columns", VisibilityMatrix::from_rows(equal, 90)});
  return all;
}

class EveryReordering : public testing::TestWithParam<Reordering> {};

TEST_P(EveryReordering, IsABijectionThatItsInverseUndoesWhateverTheThreads) {
  for (const auto& m : matrices()) {
    const std::vector<Box> boxes(m.matrix.shape().columns);
    ReorderingOptions options{.column_bounds = boxes, .threads = 1};
    const Permutation order = GetParam().order_columns(m.matrix, options);
    ASSERT_EQ(order.size(), m.matrix.shape().columns) << m.name;
    EXPECT_EQ(reordered(reordered(m.matrix, order), order.inverse()), m.matrix) << m.name;
    if (GetParam().name == "flann-tour") continue;  // FLANN takes its seeds from the system
    options.threads = 3;
    EXPECT_EQ(GetParam().order_columns(m.matrix, options), order) << m.name;
  }
}

INSTANTIATE_TEST_SUITE_P(Table, EveryReordering,
                         testing::ValuesIn(reorderings().begin(), reorderings().end()), test::table_name);

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
