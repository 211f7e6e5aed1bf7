// Tests the tour to the nearest unvisited column against its definition.
#include "layout/tours/exact_tour.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "layout/cost.h"
#include "tests/codecs/matrices.h"

namespace vismat {
namespace {

// The definition, distances by set difference.
std::vector<std::uint32_t> slow_walk(const VisibilityMatrix& matrix) {
  const VisibilityMatrix columns = transpose(matrix);
  std::set<std::uint32_t> left;
  for (std::uint32_t c = 0; c < columns.shape().rows; ++c) left.insert(c);
  std::vector<std::uint32_t> order, at;
  while (!left.empty()) {
    const std::uint32_t next = *std::ranges::min_element(left, {}, [&](std::uint32_t c) {
      std::vector<std::uint32_t> differ;
      std::ranges::set_symmetric_difference(at, columns.row(c), std::back_inserter(differ));
      return differ.size();
    });
    order.push_back(next);
    at.assign(columns.row(next).begin(), columns.row(next).end());
    left.erase(next);
  }
  return order;
}

TEST(ExactTour, EqualsTheDefinition) {
  for (const auto& m : test::assorted_matrices())
    EXPECT_EQ(order_by_exact_tour(m.matrix).old_of_new(), slow_walk(m.matrix)) << m.name;
}

}  // namespace
}  // namespace vismat
