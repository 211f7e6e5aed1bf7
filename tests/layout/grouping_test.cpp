#include "layout/groups/grouping.h"

#include <algorithm>
#include <set>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

#include "layout/groups/group_sets.h"
#include "layout/groups/pair_grouping.h"
#include "layout/groups/row_groups.h"
#include "matrix/base/random.h"
#include "matrix/loss.h"
#include "tests/table_name.h"

namespace vismat {
namespace {

using Set = std::set<std::uint32_t>;

// Rows that differ a little from one of some prototypes, no two alike.
VisibilityMatrix clustered(Shape shape, std::uint32_t prototypes, std::uint64_t seed) {
  Random random(seed);
  std::vector<std::vector<bool>> prototype(prototypes, std::vector<bool>(shape.columns));
  for (auto& bits : prototype) {
    for (std::uint32_t c = 0; c < shape.columns; ++c) bits[c] = random.below(3) == 0;
  }
  std::vector<std::vector<std::uint32_t>> rows(shape.rows);
  for (auto& row : rows) {
    const auto& bits = prototype[random.below(prototypes)];
    for (std::uint32_t c = 0; c < shape.columns; ++c) {
      if (bits[c] != (random.below(12) == 0)) row.push_back(c);
    }
  }
  return VisibilityMatrix::from_rows(rows, shape.columns);
}

// The same with few ones in many columns, whose sets are kept as lists.
VisibilityMatrix sparse(std::uint32_t rows, std::uint32_t prototypes, std::uint64_t seed,
                        std::uint32_t columns = 20000) {
  Random random(seed);
  std::vector<Set> prototype(prototypes);
  for (Set& set : prototype) {
    while (set.size() < 40) set.insert(random.below(columns));
  }
  std::vector<std::vector<std::uint32_t>> all(rows);
  for (auto& row : all) {
    Set set;
    for (const std::uint32_t c : prototype[random.below(prototypes)]) {
      if (random.below(12) > 0) set.insert(c);
    }
    for (std::uint32_t more = random.below(4); more > 0; --more) set.insert(random.below(columns));
    row.assign(set.begin(), set.end());
  }
  return VisibilityMatrix::from_rows(all, columns);
}

std::uint64_t zeros(const VisibilityMatrix& matrix) {
  return std::uint64_t{matrix.shape().rows} * matrix.shape().columns - matrix.ones();
}

Loss loss_of(const Partition& rows, const VisibilityMatrix& matrix) {
  const Loss loss = vismat::loss_of(expand_rows(merge_rows(matrix, rows), rows), matrix);
  EXPECT_EQ(loss.missing, 0u);
  return loss;
}

std::uint64_t slow_score(const Set& a, std::uint64_t in_a, const Set& b, std::uint64_t in_b) {
  const auto alone = [](const Set& whole, const Set& other) {
    return static_cast<std::uint64_t>(
        std::count_if(whole.begin(), whole.end(), [&](std::uint32_t c) { return !other.contains(c); }));
  };
  return in_a * alone(b, a) + in_b * alone(a, b);
}

// The least score of all pairs of groups, none of them empty.
std::uint64_t slow_best_score(const VisibilityMatrix& matrix, const Partition& groups) {
  const VisibilityMatrix unions = merge_rows(matrix, groups), members = groups.members();
  std::uint64_t best = RowGroups::unbounded;
  for (std::uint32_t a = 0; a < groups.groups(); ++a) {
    for (std::uint32_t b = 0; b < a; ++b) {
      const Set of_a(unions.row(a).begin(), unions.row(a).end()),
          of_b(unions.row(b).begin(), unions.row(b).end());
      best = std::min(best, slow_score(of_a, members.row(a).size(), of_b, members.row(b).size()));
    }
  }
  return best;
}

TEST(GroupSets, CountTheSameOnSeveralThreads) {
  const VisibilityMatrix matrix = clustered({900, 1500}, 5, 31);  // some 400,000 additions
  const GroupSets sets(matrix, GroupSets::Form::lists);
  const auto alone = sets.common<std::uint16_t>(sets.list(3));
  for (std::uint32_t g = 0; g < 900; ++g) {
    const std::uint32_t distance = sets.distance(3, g, 0xffffffff);
    ASSERT_EQ(2 * alone[sets.slot(g)], matrix.row(3).size() + matrix.row(g).size() - distance);
  }
  for (const unsigned threads : {2u, 3u, 64u})
    EXPECT_EQ(sets.common<std::uint16_t>(sets.list(3), threads), alone);
}

TEST(RowGroups, FindTheBestPartnerThatEverySearchFinds) {
  const VisibilityMatrix matrix = clustered({40, 90}, 5, 1);
  RowGroups groups(matrix, {});
  Random random(2);
  while (groups.alive().size() > 1) {
    const Partition partition = groups.partition();
    std::uint64_t best = RowGroups::unbounded;
    for (const std::uint32_t group : groups.alive()) {
      const auto pair = groups.best_partner(group);
      ASSERT_EQ(pair.score, groups.score(group, pair.partner));
      for (const std::uint32_t other : groups.alive()) {
        if (other != group) {
          ASSERT_LE(pair.score, groups.score(group, other));
        }
      }
      best = std::min(best, pair.score);
    }
    ASSERT_EQ(best, slow_best_score(matrix, partition));
    const std::uint32_t into =
        groups.alive()[random.below(static_cast<std::uint32_t>(groups.alive().size()))];
    const std::uint32_t from = groups.best_partner(into).partner;
    groups.merge(into, from);
    EXPECT_FALSE(groups.is_alive(from));
  }
}

// Bits and lists, searches for one partner and for several, with limits on rows and columns and without.
TEST(RowGroups, AreTheSameHoweverTheirSetsAreKept) {
  for (const bool dense : {true, false}) {
    const VisibilityMatrix matrix = dense ? clustered({36, 90}, 5, 21) : sparse(36, 5, 22, 9000);
    for (const bool limited : {true, false}) {
      GroupingOptions options;
      if (limited) {
        options.lost_in_row = dense ? .6 : .01;
        options.room_in_column.assign(matrix.shape().columns, 30);
      }
      RowGroups bits(matrix, options, GroupSets::Form::bits), lists(matrix, options, GroupSets::Form::lists);
      EXPECT_EQ(RowGroups(matrix, options).sparse(), !dense);
      for (std::uint32_t turn = 0; turn < 32; ++turn) {
        RowGroups::Pair best;
        std::uint32_t into = RowGroups::none;
        for (const std::uint32_t group : bits.alive()) {
          std::vector<RowGroups::Pair> all;
          for (const std::uint32_t other : bits.alive()) {
            if (other == group) continue;
            const std::uint64_t score = bits.score(group, other);
            ASSERT_EQ(score, lists.score(group, other));
            if (score != RowGroups::unbounded) all.push_back({score, other});
          }
          std::ranges::sort(all);
          if (!all.empty() && all.front() < best) best = all.front(), into = group;
          for (const std::uint32_t most : {6u, 1u}) {
            all.resize(std::min<std::size_t>(all.size(), most));
            ASSERT_EQ(bits.best_partners(group, most), all);
            ASSERT_EQ(lists.best_partners(group, most), all);
          }
        }
        if (into == RowGroups::none) break;
        bits.merge(into, best.partner);
        lists.merge(into, best.partner);
        ASSERT_EQ(bits.lost(), loss_of(bits.partition(), matrix).added);
        if (turn % 10 == 9) {
          ASSERT_EQ(bits.exchange(), lists.exchange());
          ASSERT_EQ(bits.lost(), loss_of(bits.partition(), matrix).added);
        }
        ASSERT_EQ(bits.lost(), lists.lost());
        ASSERT_EQ(bits.partition(), lists.partition());
      }
    }
  }
}

// Where no move regains anything, no row could be in a better group.
TEST(RowGroups, ExchangeUntilNoMoveIsWorthIt) {
  const VisibilityMatrix matrix = clustered({60, 90}, 5, 11);
  RowGroups groups(matrix, {});
  while (groups.alive().size() > 12) {  // any pairs, good or bad
    const std::uint32_t into = groups.alive()[0], from = groups.alive()[groups.alive().size() / 2];
    groups.merge(into, from);
    EXPECT_EQ(groups.lost(), loss_of(groups.partition(), matrix).added);
  }
  for (std::uint64_t regained = 1; regained > 0;) {
    const std::uint64_t before = groups.lost();
    regained = groups.exchange();
    EXPECT_EQ(groups.lost(), before - regained);
    EXPECT_EQ(groups.lost(), loss_of(groups.partition(), matrix).added);
    EXPECT_EQ(groups.partition().groups(), 12u);
  }
  const Partition partition = groups.partition();
  std::vector<std::uint32_t> map(partition.group_of_member().begin(), partition.group_of_member().end());
  for (std::uint32_t r = 0; r < 60; ++r) {
    if (std::ranges::count(map, map[r]) == 1) continue;
    for (std::uint32_t g = 0; g < 12; ++g) {
      auto moved = map;
      moved[r] = g;
      EXPECT_GE(loss_of(Partition::from_group_of_member(std::move(moved)), matrix).added, groups.lost());
    }
  }
  for (const std::uint32_t group : groups.alive()) {  // what it keeps of each group is still right
    const auto pair = groups.best_partner(group);
    for (const std::uint32_t other : groups.alive()) {
      if (other != group) {
        EXPECT_LE(pair.score, groups.score(group, other));
      }
    }
  }
}

TEST(GroupRowsByPairs, LeavesFewerGroupsWhereRowsMayMove) {
  const VisibilityMatrix matrix = clustered({400, 120}, 12, 12);
  const std::uint64_t most = zeros(matrix) / 20;
  EXPECT_LT(group_rows_by_pairs(matrix, {.lost = most}).groups(),
            group_rows_by_pairs(matrix, {.lost = most}, {.rounds = 0}).groups());
}

void expect_best_pairs(const VisibilityMatrix& matrix) {
  Partition before = group_rows_by_pairs(matrix, {.lost = 0}, {.rounds = 0});
  EXPECT_EQ(before.groups(), 30u);
  std::uint64_t lost = 0;
  while (before.groups() > 1) {
    const std::uint64_t next = slow_best_score(matrix, before);
    if (next > 0) {
      EXPECT_EQ(group_rows_by_pairs(matrix, {.lost = lost + next - 1}, {.rounds = 0}), before);
    }
    lost += next;
    const Partition after = group_rows_by_pairs(matrix, {.lost = lost}, {.rounds = 0});
    EXPECT_EQ(loss_of(after, matrix).added, lost);
    EXPECT_LT(after.groups(), before.groups());
    before = after;
  }
}

TEST(GroupRowsByPairs, AlwaysMergesTheBestPair) {
  expect_best_pairs(clustered({30, 70}, 4, 3));
  expect_best_pairs(sparse(30, 4, 3));
}

TEST(GroupRowsByPairs, LosesNextToNothingAmongNearRows) {
  const VisibilityMatrix matrix = sparse(800, 320, 41);
  const GroupingOptions options{.lost = 32000};
  const auto near = [&](unsigned threads) {
    GroupingOptions on = options;
    on.threads = threads;
    return group_rows_by_pairs(matrix, on, {.rounds = 1, .exact_seconds = 0, .few_groups = 160});
  };
  const Partition exact = group_rows_by_pairs(matrix, options, {.rounds = 1}), groups = near(1);
  EXPECT_GT(equal_rows(matrix).groups(), 530u);
  EXPECT_TRUE(RowGroups(matrix, options).sparse());
  EXPECT_LE(loss_of(groups, matrix).added, options.lost);
  EXPECT_NE(groups, exact);
  EXPECT_LT(static_cast<double>(merge_rows(matrix, groups).ones()),
            1.01 * static_cast<double>(merge_rows(matrix, exact).ones()));
  for (const unsigned threads : {2u, 5u}) EXPECT_EQ(near(threads), groups);
}

class EveryGrouping : public testing::TestWithParam<Grouping> {};

TEST_P(EveryGrouping, LosesNoMoreThanItMay) {
  const VisibilityMatrix matrix = clustered({120, 200}, 9, 4);
  std::uint32_t before = 120;
  for (const double share : {0.0, 0.01, 0.05, 0.2, 1.0}) {
    const auto most = static_cast<std::uint64_t>(share * static_cast<double>(zeros(matrix)));
    const Partition groups = GetParam().group_rows(matrix, {.lost = most});
    EXPECT_LE(loss_of(groups, matrix).added, most);
    EXPECT_LE(groups.groups(), before);
    before = groups.groups();
  }
  EXPECT_EQ(before, 1u);
}

TEST_P(EveryGrouping, LeavesNoRowWithLessThanItsShare) {
  const VisibilityMatrix matrix = clustered({120, 200}, 9, 5);
  for (const double share : {0.0, 0.03, 0.2}) {
    const Partition groups = GetParam().group_rows(matrix, {.lost = zeros(matrix), .lost_in_row = share});
    const Loss loss = loss_of(groups, matrix);
    EXPECT_LE(loss.lost_in(loss.worst_row()), share);
    if (share > 0.1) {
      EXPECT_LT(groups.groups(), 120u);
    }
  }
}

TEST_P(EveryGrouping, LeavesNoColumnWithLessThanItsRoom) {
  const VisibilityMatrix matrix = clustered({80, 60}, 5, 6);
  std::vector<std::uint32_t> room(60);
  for (std::uint32_t c = 0; c < 60; ++c) room[c] = c % 7 == 0 ? 3 : 20;
  const Partition groups = GetParam().group_rows(matrix, {.lost = zeros(matrix), .room_in_column = room});
  EXPECT_LT(groups.groups(), 80u);
  const VisibilityMatrix before = transpose(matrix),
                         after = transpose(expand_rows(merge_rows(matrix, groups), groups));
  for (std::uint32_t c = 0; c < 60; ++c) EXPECT_LE(after.row(c).size() - before.row(c).size(), room[c]) << c;
}

TEST_P(EveryGrouping, JoinsEqualRowsWhateverMayBeLost) {
  const VisibilityMatrix some = clustered({20, 50}, 3, 7);
  const Partition thrice = Partition::from_group_of_member([] {
    std::vector<std::uint32_t> map;
    for (std::uint32_t i = 0; i < 60; ++i) map.push_back(i * 7 % 20);
    return map;
  }());
  EXPECT_EQ(GetParam().group_rows(expand_rows(some, thrice), {.lost = 0}).groups(), 20u);
}

TEST_P(EveryGrouping, GivesTheSameGroupsForAnyThreadCount) {
  for (const VisibilityMatrix& matrix : {clustered({150, 100}, 6, 8), sparse(150, 6, 8)}) {
    const auto groups = [&](unsigned threads) {
      return GetParam().group_rows(matrix, {.lost = 800, .seed = 3, .threads = threads});
    };
    const Partition one = groups(1);
    EXPECT_LT(one.groups(), 150u);
    for (const unsigned threads : {2u, 4u, 7u}) EXPECT_EQ(groups(threads), one);
  }
}

TEST_P(EveryGrouping, KeepsLimitsOnSparseRows) {
  const VisibilityMatrix matrix = sparse(120, 9, 4);
  const std::vector<std::uint32_t> room(matrix.shape().columns, 9);
  for (const std::uint64_t most : {std::uint64_t{0}, std::uint64_t{500}, zeros(matrix)}) {
    const Partition groups = GetParam().group_rows(matrix, {.lost = most});
    EXPECT_LE(loss_of(groups, matrix).added, most);
    EXPECT_EQ(groups.groups() == 1, most == zeros(matrix));
    const Partition within =
        GetParam().group_rows(matrix, {.lost = most, .lost_in_row = .002, .room_in_column = room});
    EXPECT_EQ(within.groups() < 120, most > 0);
    const VisibilityMatrix lossy = expand_rows(merge_rows(matrix, within), within);
    const Loss loss = vismat::loss_of(lossy, matrix);
    EXPECT_LE(loss.lost_in(loss.worst_row()), .002);
    const VisibilityMatrix before = transpose(matrix), after = transpose(lossy);
    for (std::uint32_t c = 0; c < room.size(); ++c)
      EXPECT_LE(after.row(c).size() - before.row(c).size(), room[c]);
  }
}

TEST_P(EveryGrouping, TakesEqualEmptyAndEquallyFarRows) {
  std::vector<std::vector<std::uint32_t>> one(60, std::vector<std::uint32_t>{7}), apart(60), some = one;
  for (std::uint32_t r = 0; r < 60; ++r) apart[r] = {100 * r};
  for (std::uint32_t r = 0; r < 60; r += 2) some[r].clear();
  const auto groups_of = [&](const VisibilityMatrix& matrix, std::uint64_t lost) {
    const Partition groups = GetParam().group_rows(matrix, {.lost = lost});
    EXPECT_LE(loss_of(groups, matrix).added, lost);
    return groups.groups();
  };
  EXPECT_EQ(groups_of(VisibilityMatrix({60, 6000}), 0), 1u);
  EXPECT_EQ(groups_of(VisibilityMatrix::from_rows(one, 6000), 0), 1u);
  EXPECT_EQ(groups_of(VisibilityMatrix::from_rows(std::vector(60, std::vector<std::uint32_t>{0}), 1), 0), 1u);
  EXPECT_EQ(groups_of(VisibilityMatrix::from_rows(some, 6000), 29), 2u);
  EXPECT_EQ(groups_of(VisibilityMatrix::from_rows(some, 6000), 30), 1u);
  EXPECT_EQ(groups_of(VisibilityMatrix::from_rows(apart, 6000), 1), 60u);
  EXPECT_EQ(groups_of(VisibilityMatrix::from_rows(apart, 6000), 60), 30u);  // 30 pairs, each for 2
}

TEST_P(EveryGrouping, TakesMatricesOfAnyShape) {
  for (const Shape shape : {Shape{0, 0}, Shape{0, 5}, Shape{1, 0}, Shape{5, 0}, Shape{1, 1}}) {
    const Partition groups = GetParam().group_rows(VisibilityMatrix(shape), {.lost = 10});
    EXPECT_EQ(groups.size(), shape.rows);
    EXPECT_EQ(groups.groups(), std::min(shape.rows, 1u));
  }
}

TEST_P(EveryGrouping, SharesWhatMayBeLostAmongBothSides) {
  const VisibilityMatrix matrix = clustered({90, 110}, 6, 9);
  const auto most = zeros(matrix) / 10;
  for (const MergeSide side : {MergeSide::rows, MergeSide::columns, MergeSide::both}) {
    for (const double in_row : {1.0, 0.12}) {
      const MergeGroups groups = group_sides(matrix, side, GetParam(), {.lost = most, .lost_in_row = in_row});
      EXPECT_EQ(groups.rows.has_value(), side != MergeSide::columns);
      EXPECT_EQ(groups.columns.has_value(), side != MergeSide::rows);
      VisibilityMatrix lossy = matrix;
      if (groups.rows) lossy = expand_rows(merge_rows(lossy, *groups.rows), *groups.rows);
      if (groups.columns) lossy = expand_columns(merge_columns(lossy, *groups.columns), *groups.columns);
      const Loss loss = vismat::loss_of(lossy, matrix);
      EXPECT_EQ(loss.missing, 0u);
      EXPECT_LE(loss.added, most);
      EXPECT_LE(loss.lost_in(loss.worst_row()), in_row);
      EXPECT_GT(loss.added, 0u);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Table, EveryGrouping, testing::ValuesIn(groupings().begin(), groupings().end()),
                         test::table_name);

TEST(Groupings, AreFoundByName) {
  EXPECT_EQ(find_grouping("seeds").name, "seeds");
  EXPECT_THROW(find_grouping("none"), std::invalid_argument);
}

// Which groups are drawn depends on the seed alone.
TEST(GroupRowsBySeeds, DrawsByTheSeed) {
  const VisibilityMatrix matrix = clustered({150, 100}, 6, 8);
  const auto groups = [&](std::uint64_t seed) {
    return find_grouping("seeds").group_rows(matrix, {.lost = 3000, .seed = seed});
  };
  EXPECT_EQ(groups(1), groups(1));
  EXPECT_NE(groups(1), groups(2));
}

}  // namespace
}  // namespace vismat
