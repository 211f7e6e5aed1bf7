// Tests the order of columns as bit strings.
#include "layout/orders/lexicographic_order.h"

#include <gtest/gtest.h>

namespace vismat {
namespace {

TEST(Lexicographic, SortsBitStringsWithOnesFirst) {
  const auto m = VisibilityMatrix::from_rows({{2, 4}, {0, 2}, {1, 4}}, 5);  // columns 010, 001, 110, 000, 101
  EXPECT_EQ(lexicographic_order(m).old_of_new(), (std::vector<std::uint32_t>{2, 4, 0, 1, 3}));
}

}  // namespace
}  // namespace vismat
