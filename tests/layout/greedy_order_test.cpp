#include "layout/orders/greedy_order.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "tests/codecs/matrices.h"

namespace vismat {
namespace {

std::size_t distance(const VisibilityMatrix& m, std::uint32_t a, std::uint32_t b) {
  std::vector<std::uint32_t> differ;
  std::ranges::set_symmetric_difference(m.row(a), m.row(b), std::back_inserter(differ));
  return differ.size();
}

std::uint32_t smallest_row(const VisibilityMatrix& m, const std::set<std::uint32_t>& among) {
  return *std::ranges::min_element(among, {}, [&](std::uint32_t r) { return m.row(r).size(); });
}

std::set<std::uint32_t> all_rows(const VisibilityMatrix& m) {
  std::set<std::uint32_t> rows;
  for (std::uint32_t r = 0; r < m.shape().rows; ++r) rows.insert(r);
  return rows;
}

// The definition, without an index.
std::vector<std::uint32_t> slow_greedy(const VisibilityMatrix& m) {
  std::set<std::uint32_t> left = all_rows(m);
  std::vector<std::uint32_t> order;
  while (!left.empty()) {
    const std::uint32_t next =
        order.empty() ? smallest_row(m, left) : *std::ranges::min_element(left, {}, [&](std::uint32_t r) {
          return distance(m, order.back(), r);
        });
    order.push_back(next);
    left.erase(next);
  }
  return order;
}

TEST(GreedyOrder, EqualsTheDefinition) {
  for (const auto& m : test::assorted_matrices()) {
    EXPECT_EQ(order_rows_greedily(m.matrix).old_of_new(), slow_greedy(m.matrix)) << m.name;
  }
}

TEST(GreedyOrder, FindsAShuffledPlantedOrder) {
  std::vector<std::vector<std::uint32_t>> rows;  // row i sees columns 0 .. i - 1
  for (std::uint32_t i = 0; i < 200; ++i) {
    std::vector<std::uint32_t> row(i * 77 % 200);
    for (std::uint32_t c = 0; c < row.size(); ++c) row[c] = c;
    rows.push_back(row);
  }
  const auto m = VisibilityMatrix::from_rows(rows, 200);
  const auto order = order_rows_greedily(m).old_of_new();
  for (std::uint32_t i = 0; i < 200; ++i) EXPECT_EQ(m.row(order[i]).size(), i);
}

TEST(NeighbourOrder, StepsToFreeNeighboursWhereThereAre) {
  const auto m = test::clustered_matrix({40, 60}, 9);
  std::vector<std::vector<std::uint32_t>> ring(40);
  for (std::uint32_t i = 0; i < 40; ++i)
    ring[i] = {std::min((i + 1) % 40, (i + 39) % 40), std::max((i + 1) % 40, (i + 39) % 40)};
  const auto neighbours = VisibilityMatrix::from_rows(ring, 40);
  const auto order = order_rows_by_neighbours(m, neighbours).old_of_new();
  EXPECT_EQ(order.front(), smallest_row(m, all_rows(m)));
  const auto nearer =
      std::ranges::min_element(ring[order[0]], {}, [&](std::uint32_t r) { return distance(m, order[0], r); });
  for (std::uint32_t i = 1; i < 40; ++i) {  // on a ring the first choice fixes the direction
    const std::uint32_t step = (*nearer + 40 - order[0]) % 40;
    EXPECT_EQ(order[i], (order[i - 1] + step) % 40);
  }
}

TEST(NeighbourOrder, IsABijectionOnIslands) {
  const auto m = test::random_matrix({30, 20}, .4, 3);
  EXPECT_EQ(order_rows_by_neighbours(m, VisibilityMatrix(Shape{30, 30})).size(), 30u);
}

}  // namespace
}  // namespace vismat
