// Tests trees over rows by their visible sets.
#include <gtest/gtest.h>

#include <algorithm>

#include "layout/orders/random_order.h"
#include "layout/trees/set_tree.h"
#include "matrix/permutation.h"
#include "tests/codecs/matrices.h"

namespace vismat {
namespace {

// How many ones the sets of all nodes with children have: the cost of storing each row above a pair of leaves.
std::uint64_t members_of_inner_nodes(const VisibilityMatrix& matrix, const ObjectTree& tree) {
  const VisibilityMatrix sets = transpose(nodes_from_objects(transpose(matrix), tree));
  std::uint64_t members = 0;
  for (std::uint32_t n = 0; n < tree.size(); ++n)
    members += tree.children(n).empty() ? 0 : sets.row(n).size();
  return members;
}

TEST(TreeBySets, IsBinaryWithEachRowInOneLeaf) {
  for (const auto& [name, matrix] : test::assorted_matrices(true)) {
    const std::uint32_t rows = matrix.shape().rows;
    const ObjectTree tree = tree_by_sets(matrix);
    ASSERT_EQ(tree.size(), rows == 0 ? 0 : 2 * rows - 1) << name;
    EXPECT_EQ(tree.object_count(), rows) << name;
    std::vector<int> leafs(rows, 0);
    for (std::uint32_t n = 0; n < tree.size(); ++n) {
      const std::uint32_t row = tree.object_of_node()[n];
      EXPECT_EQ(tree.children(n).size(), row == ObjectTree::none ? 2u : 0u) << name;
      if (row != ObjectTree::none) ++leafs[row];
    }
    EXPECT_EQ(leafs, std::vector<int>(rows, 1)) << name;
    EXPECT_EQ(tree_by_sets(matrix), tree) << name;
  }
}

TEST(TreeBySets, FindsShuffledNeighbours) {
  const VisibilityMatrix planted = test::banded_matrix(200, 20, 1);
  const std::uint32_t rows = planted.shape().rows;
  const VisibilityMatrix shuffled =
      permute(planted, random_order(rows, 5), Permutation::identity(planted.shape().columns));
  const std::uint64_t even = members_of_inner_nodes(planted, test::even_tree(rows, 2)),
                      random = members_of_inner_nodes(shuffled, test::even_tree(rows, 2)),
                      found = members_of_inner_nodes(shuffled, tree_by_sets(shuffled));
  EXPECT_LT(even, random);
  EXPECT_LT(found, even + even / 20);
}

// Rows that are all alike, and rows each inside the next, must not make a chain.
TEST(TreeBySets, StaysShallowWhereDistancesTie) {
  std::vector<std::vector<std::uint32_t>> equal(256, {1, 2, 3}), nested(256);
  for (std::uint32_t r = 0; r < 256; ++r) {
    for (std::uint32_t c = 0; c <= r; ++c) nested[r].push_back(c);
  }
  for (const auto& rows : {equal, nested}) {
    const ObjectTree tree = tree_by_sets(VisibilityMatrix::from_rows(rows, 256));
    std::uint32_t deepest = 0;
    std::vector<std::uint32_t> depth(tree.size(), 0);
    for (std::uint32_t n = 1; n < tree.size(); ++n)
      deepest = std::max(deepest, depth[n] = depth[tree.parent_of_node()[n]] + 1);
    EXPECT_LE(deepest, 16u);
  }
}

}  // namespace
}  // namespace vismat
