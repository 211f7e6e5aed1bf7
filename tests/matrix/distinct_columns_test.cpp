// Tests that equal columns are collapsed into one and expanded again.
#include "matrix/points/distinct_columns.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "layout/cost.h"
#include "layout/orders/random_order.h"
#include "tests/codecs/matrices.h"

namespace vismat {
namespace {

TEST(DistinctColumns, CollapseAndUnfold) {
  const auto m = VisibilityMatrix::from_rows({{0, 2, 3}, {1, 3}, {0, 2}}, 5);
  const DistinctColumns d = distinct_columns(m);
  EXPECT_EQ(d.distinct_of_column, (std::vector<std::uint32_t>{0, 1, 0, 2, 3}));
  EXPECT_EQ(d.matrix, VisibilityMatrix::from_rows({{0, 2}, {1, 2}, {0}}, 4));
  const auto order = unfold(Permutation::from_old_of_new({3, 0, 2, 1}), d.distinct_of_column);
  EXPECT_EQ(order.old_of_new(), (std::vector<std::uint32_t>{4, 0, 2, 3, 1}));
}

TEST(DistinctColumns, AreTheColumnsOnceEach) {
  for (const auto& m : test::assorted_matrices()) {
    const DistinctColumns d = distinct_columns(m.matrix);
    const VisibilityMatrix columns = transpose(m.matrix), kinds = transpose(d.matrix);
    ASSERT_EQ(d.distinct_of_column.size(), m.matrix.shape().columns) << m.name;
    std::vector<std::vector<std::uint32_t>> all;
    for (std::uint32_t k = 0; k < kinds.shape().rows; ++k)
      all.emplace_back(kinds.row(k).begin(), kinds.row(k).end());
    for (std::uint32_t c = 0; c < columns.shape().rows; ++c)
      EXPECT_TRUE(std::ranges::equal(columns.row(c), kinds.row(d.distinct_of_column[c])))
          << m.name << ' ' << c;
    std::sort(all.begin(), all.end());
    EXPECT_TRUE(std::adjacent_find(all.begin(), all.end()) == all.end()) << m.name;
    const Permutation order = random_order(d.matrix.shape().columns, 3);
    EXPECT_EQ(count_runs(m.matrix, unfold(order, d.distinct_of_column)), count_runs(d.matrix, order))
        << m.name;
  }
}

}  // namespace
}  // namespace vismat
