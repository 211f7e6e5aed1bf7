#include "layout/trees/nearest_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <tuple>
#include <vector>

#include "matrix/base/random.h"
#include "matrix/base/union_find.h"
#include "matrix/bit_rows.h"
#include "matrix/points/point_comparison.h"

namespace vismat {
namespace {

// `kinds` different rows at most, like one another as cells in a row of rooms are.
VisibilityMatrix random_rows(Shape shape, std::uint32_t kinds, Random& random) {
  std::vector<std::vector<bool>> of_kind(kinds, std::vector<bool>(shape.columns, false));
  for (std::uint32_t k = 1; k < kinds; ++k) {
    of_kind[k] = of_kind[random.below(k)];
    for (std::uint32_t flips = random.below(20); flips > 0 && shape.columns > 0; --flips)
      of_kind[k][random.below(shape.columns)].flip();
  }
  std::vector<std::vector<std::uint32_t>> rows(shape.rows);
  for (auto& row : rows) {
    const auto& bits = of_kind[random.below(kinds)];
    for (std::uint32_t c = 0; c < shape.columns; ++c) {
      if (bits[c]) row.push_back(c);
    }
  }
  return VisibilityMatrix::from_rows(rows, shape.columns);
}

// Kruskal's algorithm over all pairs.
std::uint64_t least_length(const BitRows& bits) {
  const std::uint32_t rows = bits.shape().rows;
  std::vector<std::tuple<std::uint32_t, std::uint32_t, std::uint32_t>> pairs;
  for (std::uint32_t a = 0; a < rows; ++a) {
    for (std::uint32_t b = 0; b < a; ++b)
      pairs.emplace_back(hamming_distance(bits.row(a), bits.row(b)), a, b);
  }
  std::ranges::sort(pairs);
  UnionFind components(rows);
  std::uint64_t length = 0;
  for (const auto& [distance, a, b] : pairs) {
    const std::uint32_t one = components.find(a), other = components.find(b);
    if (one == other) continue;
    components.join(one, other);
    length += distance;
  }
  return length;
}

void expect_least_tree(const VisibilityMatrix& matrix) {
  const std::uint32_t rows = matrix.shape().rows;
  const VisibilityMatrix tree = nearest_tree(matrix);
  ASSERT_EQ(tree.shape(), (Shape{rows, rows}));
  EXPECT_EQ(tree, transpose(tree));
  const BitRows bits(matrix);
  UnionFind components(rows);
  std::uint64_t length = 0, pairs = 0;
  for (std::uint32_t a = 0; a < rows; ++a) {
    for (const std::uint32_t b : tree.row(a)) {
      if (b > a) continue;
      const std::uint32_t one = components.find(a), other = components.find(b);
      ASSERT_NE(one, other) << "a circle through " << a << " and " << b;
      components.join(one, other);
      ++pairs;
      length += hamming_distance(bits.row(a), bits.row(b));
    }
  }
  EXPECT_EQ(pairs, rows == 0 ? 0 : rows - 1);
  EXPECT_EQ(length, least_length(bits));
}

TEST(NearestTree, IsAsShortAsKruskals) {
  Random random(1);
  for (int i = 0; i < 60; ++i) {
    const Shape shape = {1 + random.below(60), random.below(200)};
    expect_least_tree(random_rows(shape, 1 + random.below(shape.rows + 20), random));
  }
}

// Their distances come from an index, those of dense rows from bits.
TEST(NearestTree, IsAsShortForSparseRows) {
  Random random(3);
  for (const std::uint32_t columns : {20000u, 90u}) {
    const VisibilityMatrix matrix = random_rows({80, columns}, 70, random);
    EXPECT_EQ(all_pairs_cost(SparsePoints(transpose(matrix))).index_beats_limited_bits(), columns == 20000);
    expect_least_tree(matrix);
  }
}

TEST(NearestTree, TakesWhatIsEmptyOrAllEqual) {
  for (const Shape shape : {Shape{0, 0}, Shape{0, 9}, Shape{1, 0}, Shape{1, 9}, Shape{50, 0}, Shape{50, 9}})
    expect_least_tree(VisibilityMatrix(shape));
  expect_least_tree(VisibilityMatrix::from_rows({{1, 2}, {1, 2}, {1, 2}}, 3));
}

TEST(NearestTree, PrefersTheFirstOfEquals) {
  // Rows 1 and 2 are as near to 0 as to one another; 3 is row 0 again.
  const auto matrix = VisibilityMatrix::from_rows({{0, 1}, {0, 2}, {1, 2}, {0, 1}}, 3);
  EXPECT_EQ(nearest_tree(matrix), VisibilityMatrix::from_rows({{1, 2, 3}, {0}, {0}, {0}}, 4));
  // Row 3 is as near to 1 as to 2, and 1 joins first.
  const auto square = VisibilityMatrix::from_rows({{2}, {0, 2}, {1, 2}, {0, 1, 2}}, 3);
  EXPECT_EQ(nearest_tree(square), VisibilityMatrix::from_rows({{1, 2}, {0, 3}, {0}, {1}}, 4));
}

TEST(NearestTree, ProgressAscendsToTheDistinctRows) {
  Random random(2);
  std::vector<std::uint64_t> seen;
  const auto matrix = random_rows({40, 100}, 40, random);
  nearest_tree(matrix, [&](std::uint64_t done, std::uint64_t total) {
    EXPECT_LE(total, 40u);
    EXPECT_LE(done, total);
    seen.push_back(done);
  });
  EXPECT_TRUE(std::ranges::is_sorted(seen));
  EXPECT_GT(seen.size(), 5u);
}

}  // namespace
}  // namespace vismat
