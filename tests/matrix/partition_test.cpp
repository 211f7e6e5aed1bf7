#include "matrix/partition.h"

#include <algorithm>
#include <set>
#include <stdexcept>

#include <gtest/gtest.h>

#include "matrix/base/random.h"
#include "matrix/loss.h"

namespace vismat {
namespace {

Partition random_groups(std::uint32_t members, std::uint32_t groups, std::uint64_t seed) {
  Random random(seed);
  std::vector<std::uint32_t> map(members);
  for (std::uint32_t m = 0; m < members; ++m) map[m] = m < groups ? m : random.below(groups);
  return Partition::from_group_of_member(std::move(map));
}

VisibilityMatrix random_matrix(Shape shape, std::uint64_t seed) {
  Random random(seed);
  std::vector<std::vector<std::uint32_t>> rows(shape.rows);
  for (auto& row : rows) {
    for (std::uint32_t c = 0; c < shape.columns; ++c) {
      if (random.below(4) == 0) row.push_back(c);
    }
  }
  return VisibilityMatrix::from_rows(rows, shape.columns);
}

TEST(Partition, RefusesGroupsWithoutMembers) {
  EXPECT_THROW(Partition::from_group_of_member({0, 2, 2}), std::invalid_argument);
  EXPECT_THROW(Partition::from_group_of_member({1}), std::invalid_argument);
  EXPECT_THROW(Partition::from_group_of_member({0, 0xffffffff}), std::invalid_argument);
  EXPECT_EQ(Partition::from_group_of_member({}).groups(), 0u);
}

TEST(Partition, ListsMembersAndFollowsOnFromGroupsAndOrders) {
  const auto first = Partition::from_group_of_member({0, 1, 0, 2});
  EXPECT_EQ(first.members(), VisibilityMatrix::from_rows({{0, 2}, {1}, {3}}, 4));
  EXPECT_EQ(followed_by(first, Partition::from_group_of_member({1, 0, 1})),
            Partition::from_group_of_member({1, 0, 1, 1}));
  EXPECT_EQ(renumbered(first, Permutation::from_new_of_old({2, 0, 1})),
            Partition::from_group_of_member({2, 0, 2, 1}));
}

// Each merged entry is looked up member by member.
TEST(Partition, MergesIntoUnionsAndExpandsThem) {
  const VisibilityMatrix matrix = random_matrix({40, 30}, 1);
  const Partition rows = random_groups(40, 12, 2), columns = random_groups(30, 9, 3);
  const VisibilityMatrix merged = merge_columns(merge_rows(matrix, rows), columns);
  std::set<std::pair<std::uint32_t, std::uint32_t>> truth;
  for (std::uint32_t r = 0; r < 40; ++r) {
    for (const std::uint32_t c : matrix.row(r))
      truth.insert({rows.group_of_member()[r], columns.group_of_member()[c]});
  }
  EXPECT_EQ(merged.shape(), (Shape{12, 9}));
  EXPECT_EQ(merged.ones(), truth.size());
  for (const auto& [r, c] : truth) EXPECT_TRUE(merged.contains(r, c));
  const VisibilityMatrix expanded = expand_columns(expand_rows(merged, rows), columns);
  for (std::uint32_t r = 0; r < 40; ++r) {
    for (std::uint32_t c = 0; c < 30; ++c)
      EXPECT_EQ(expanded.contains(r, c),
                merged.contains(rows.group_of_member()[r], columns.group_of_member()[c]));
  }
  EXPECT_EQ(loss_of(expanded, matrix).missing, 0u);
  EXPECT_EQ(merge_rows(matrix, Partition::identity(40)), matrix);
}

TEST(Loss, CountsEntryByEntry) {
  const VisibilityMatrix original = random_matrix({30, 70}, 4), other = random_matrix({30, 70}, 5);
  const Loss loss = loss_of(other, original);
  std::uint64_t added = 0, missing = 0;
  std::optional<Loss::Entry> first;
  for (std::uint32_t r = 0; r < 30; ++r) {
    std::uint32_t in_row = 0;
    for (std::uint32_t c = 0; c < 70; ++c) {
      in_row += other.contains(r, c) && !original.contains(r, c);
      if (!other.contains(r, c) && original.contains(r, c)) {
        ++missing;
        if (!first) first = Loss::Entry{r, c};
      }
    }
    EXPECT_EQ(loss.rows[r], (RowLoss{static_cast<std::uint32_t>(original.row(r).size()), in_row}));
    EXPECT_LE(loss.lost_in(r), loss.lost_in(loss.worst_row()));
    added += in_row;
  }
  EXPECT_EQ(loss.added, added);
  EXPECT_EQ(loss.missing, missing);
  EXPECT_EQ(loss.first_missing, first);
  EXPECT_DOUBLE_EQ(loss.lost(), static_cast<double>(added) / static_cast<double>(30 * 70 - original.ones()));
}

TEST(Loss, OfGroupsIsThatOfTheirMembers) {
  const VisibilityMatrix original = random_matrix({40, 30}, 8);
  const Partition rows = random_groups(40, 9, 3);
  const VisibilityMatrix merged = merge_rows(original, rows);
  const Loss loss = loss_of(merged, rows, original), expanded = loss_of(expand_rows(merged, rows), original);
  EXPECT_GT(loss.added, 0u);
  EXPECT_EQ(loss.added, expanded.added);
  EXPECT_EQ(loss.rows, expanded.rows);
  EXPECT_THROW(loss_of(merged, original), std::invalid_argument);
}

TEST(Loss, OfTheSameMatrixIsNothing) {
  const VisibilityMatrix matrix = random_matrix({5, 9}, 6);
  const Loss loss = loss_of(matrix, matrix);
  EXPECT_EQ(loss.added + loss.missing, 0u);
  EXPECT_EQ(loss.lost(), 0);
  EXPECT_EQ(loss_of(VisibilityMatrix(Shape{0, 5}), VisibilityMatrix(Shape{0, 5})).lost(), 0);
  EXPECT_THROW(loss_of(matrix, VisibilityMatrix(Shape{9, 5})), std::invalid_argument);
}

}  // namespace
}  // namespace vismat
