// Tests how runs of ones are counted.
#include "layout/cost.h"

#include <gtest/gtest.h>

#include "layout/orders/random_order.h"
#include "tests/codecs/matrices.h"

namespace vismat {
namespace {

TEST(Cost, CountsGroupsOfOnes) {
  EXPECT_EQ(count_runs(VisibilityMatrix::from_rows({{0, 1, 3}, {}, {2}, {0, 1, 2, 3}}, 4)), 4u);
  EXPECT_EQ(count_runs(VisibilityMatrix(Shape{3, 3})), 0u);
}

TEST(Cost, OfAnOrderIsThatOfTheReorderedMatrix) {
  for (const auto& m : test::assorted_matrices()) {
    const auto order = random_order(m.matrix.shape().columns, 5);
    const Permutation rows = Permutation::identity(m.matrix.shape().rows);
    EXPECT_EQ(count_runs(m.matrix, order), count_runs(permute(m.matrix, rows, order))) << m.name;
  }
}

}  // namespace
}  // namespace vismat
