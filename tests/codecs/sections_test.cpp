#include "codecs/vmat/sections.h"

#include <algorithm>
#include <bit>

#include <gtest/gtest.h>

#include "codecs/baselines/baseline_codecs.h"
#include "codecs/entropy/bit_stream.h"
#include "codecs/vmat/container.h"
#include "codecs/vmat/row_reader.h"
#include "matrix/base/byte_reader.h"
#include "matrix/base/random.h"
#include "tests/codecs/matrices.h"

namespace vismat {
namespace {

// Members join one of the last few groups, or begin one.
Partition local_groups(std::uint32_t members, std::uint64_t seed) {
  Random random(seed);
  std::vector<std::uint32_t> map;
  std::uint32_t groups = 0;
  for (std::uint32_t m = 0; m < members; ++m) {
    const bool begins = groups == 0 || random.below(8) == 0;
    map.push_back(begins ? groups : groups - 1 - random.below(std::min(groups, 8u)));
    groups += begins;
  }
  return Partition::from_group_of_member(std::move(map));
}

TEST(GroupSection, KeepsGroupsInAnyOrder) {
  for (const std::uint32_t members : {0u, 1u, 2u, 63u, 1000u}) {
    const Partition sorted = local_groups(members, members);
    std::vector<std::uint32_t> back(sorted.groups());
    for (std::uint32_t g = 0; g < back.size(); ++g) back[g] = sorted.groups() - 1 - g;
    const Partition turned = renumbered(sorted, Permutation::from_new_of_old(std::move(back)));
    for (const Partition& groups : {sorted, turned, Partition::identity(members)})
      EXPECT_EQ(groups_from_bytes(group_bytes(groups), groups.groups()), groups) << members;
  }
}

TEST(GroupSection, IsSmallWhereMembersStandTogether) {
  const Partition groups = local_groups(10000, 3);
  const std::size_t plain = 10000 * std::bit_width(groups.groups()) / 8;
  EXPECT_LT(group_bytes(groups).size(), plain / 2);
}

TEST(GroupSection, RefusesEveryPrefixAndWhatNoWriterMade) {
  const Partition groups = local_groups(200, 5);
  const auto good = group_bytes(groups);
  for (std::size_t size = 1; size < good.size(); ++size)
    EXPECT_THROW(groups_from_bytes(std::span(good).first(size), groups.groups()), FormatError) << size;
  auto longer = good;
  longer.push_back(std::byte{0});
  EXPECT_THROW(groups_from_bytes(longer, groups.groups()), FormatError);
  EXPECT_THROW(groups_from_bytes(good, groups.groups() + 1), FormatError);
  for (std::size_t bit = 0; bit < 8 * good.size(); ++bit) {
    auto bad = good;
    bad[bit / 8] ^= std::byte{1} << (bit % 8);
    try {  // what is read is what would be written
      const auto read = groups_from_bytes(bad, groups.groups());
      EXPECT_EQ(group_bytes(read.value()), bad) << bit;
    } catch (const FormatError&) {
    }
  }
}

TEST(GroupSection, StandsInPlaceOfAnOrder) {
  Container container = compress(test::clustered_matrix({20, 30}, 4), find_codec("delimiter"));
  std::vector<std::uint32_t> groups(50);
  for (std::uint32_t m = 0; m < 50; ++m) groups[m] = (m * 7) % 20;
  container.source.row_groups = Partition::from_group_of_member(groups);
  container.source.column_groups = Partition::identity(30);
  const auto file = write_container(container);
  const RowReader reader(file);
  EXPECT_EQ(reader.source(), container.source);
  container.source.row_order = Permutation::identity(20);
  EXPECT_THROW(write_container(container), std::invalid_argument);
}

// Every prefix, one byte more, and every flipped bit: what is read is what would be written.
template <typename Read, typename Write>
void expect_one_code(const std::vector<std::byte>& good, const Read& read, const Write& write) {
  EXPECT_EQ(write(read(good)), good);
  const auto same_or_refused = [&](const std::vector<std::byte>& bad) {
    try {
      EXPECT_EQ(write(read(bad)), bad);
    } catch (const FormatError&) {
    }
  };
  for (std::size_t size = 1; size < good.size(); ++size)
    same_or_refused({good.begin(), good.begin() + static_cast<std::ptrdiff_t>(size)});
  auto longer = good;
  longer.push_back(std::byte{0});
  same_or_refused(longer);
  for (std::size_t bit = 0; bit < 8 * good.size(); ++bit) {
    auto bad = good;
    bad[bit / 8] ^= std::byte{1} << (bit % 8);
    same_or_refused(bad);
  }
}

Permutation shuffled(std::uint32_t size, std::uint64_t seed) {
  Random random(seed);
  std::vector<std::uint32_t> map(size);
  for (std::uint32_t i = 0; i < size; ++i) {
    map[i] = i;
    std::swap(map[i], map[random.below(i + 1)]);
  }
  return Permutation::from_new_of_old(std::move(map));
}

// Steps up and down through near numbers, as tours make them.
Permutation tour_like(std::uint32_t size, std::uint64_t seed) {
  Random random(seed);
  std::vector<std::uint32_t> visits, left(size);
  for (std::uint32_t i = 0; i < size; ++i) left[i] = i;
  std::size_t at = 0;
  while (!left.empty()) {
    const std::size_t step = random.below(4) == 0 ? random.below(40) : random.below(3);
    at = random.below(5) < 2 ? at - std::min(at, step) : at + step;
    at = std::min(at, left.size() - 1);
    visits.push_back(left[at]);
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(at));
  }
  return Permutation::from_old_of_new(std::move(visits));
}

TEST(OrderSection, KeepsAnyOrder) {
  for (const std::uint32_t size : {0u, 1u, 2u, 3u, 64u, 65u, 1000u}) {
    for (const Permutation& order : {Permutation::identity(size), shuffled(size, size), tour_like(size, size),
                                     tour_like(size, size).inverse()})
      EXPECT_EQ(order_from_bytes(order_bytes(order), size), order) << size;
  }
}

TEST(OrderSection, TakesLessThanTheLogarithmWhereStepsAreShort) {
  const std::size_t bound = permutation_bytes(5000);
  EXPECT_LT(order_bytes(tour_like(5000, 1)).size(), bound * 6 / 10);
  EXPECT_EQ(order_bytes(tour_like(5000, 1).inverse()).size(), order_bytes(tour_like(5000, 1)).size());
  EXPECT_LT(order_bytes(shuffled(5000, 1)).size(), bound * 11 / 10);
  EXPECT_LT(order_bytes(Permutation::identity(5000)).size(), 20u);
}

// All short orders, and many longer ones: what is written is read. Some end in more zeros than others, which the writer leaves out.
TEST(OrderSection, ReadsEveryShortOrder) {
  const auto unlucky = Permutation::from_old_of_new({1, 0, 2, 6, 4, 5, 3});
  EXPECT_EQ(order_from_bytes(order_bytes(unlucky), 7), unlucky);
  for (std::uint32_t size = 0; size <= 7; ++size) {
    std::vector<std::uint32_t> map(size);
    for (std::uint32_t i = 0; i < size; ++i) map[i] = i;
    do {
      const auto order = Permutation::from_new_of_old(map);
      ASSERT_EQ(order_from_bytes(order_bytes(order), size), order);
    } while (std::next_permutation(map.begin(), map.end()));
  }
  for (std::uint64_t seed = 0; seed < 3000; ++seed) {
    const auto order = shuffled(10 + static_cast<std::uint32_t>(seed % 90), seed);
    ASSERT_EQ(order_from_bytes(order_bytes(order), order.size()), order) << seed;
  }
}

TEST(TreeSection, ReadsManySmallTrees) {
  Random random(9);
  for (int trial = 0; trial < 3000; ++trial) {
    std::vector<std::uint32_t> parents = {ObjectTree::none}, objects = {ObjectTree::none};
    const std::uint32_t size = 1 + random.below(20);
    for (std::uint32_t n = 1; n < size; ++n) {
      parents.push_back(random.below(2) == 0 ? (n - 1) / 2 : random.below(n));
      objects.push_back(random.below(3) == 0 ? ObjectTree::none : random.below(8));
    }
    const auto tree = ObjectTree::from_parents(parents, objects, 8);
    ASSERT_EQ(tree_from_bytes(tree_bytes(tree, false)).first, tree) << trial;
  }
}

TEST(OrderSection, HasOneCodeForEachOrder) {
  for (const Permutation& order : {tour_like(40, 2), shuffled(20, 3), Permutation::identity(9)}) {
    expect_one_code(
        order_bytes(order),
        [&](std::span<const std::byte> bytes) { return order_from_bytes(bytes, order.size()).value(); },
        order_bytes);
  }
  EXPECT_THROW(order_from_bytes(order_bytes(Permutation::identity(9)), 10), FormatError);
}

// As many places as 2^32 - 1 in two bytes are refused before memory is taken for them.
TEST(OrderSection, RefusesClaims) {
  const std::vector<std::byte> few = {std::byte{0}, std::byte{0}};
  EXPECT_THROW(order_from_bytes(few, 0xffffffff), FormatError);
}

std::vector<ObjectTree> assorted_trees() {
  constexpr auto none = ObjectTree::none;
  std::vector<ObjectTree> trees = {ObjectTree{}, test::even_tree(1, 2), test::even_tree(200, 2),
                                   test::even_tree(77, 5)};
  trees.push_back(
      ObjectTree::from_parents({none, 0, 1, 1, 0, 4, 4}, {none, none, 2, 0, none, 1, 2}, 3));  // by branches
  trees.push_back(
      ObjectTree::from_parents({none, 0, 0, 2, 1, 2, 1}, {5, 0, 0, 0, none, 4, none}, 6));  // neither way
  Random random(8);
  std::vector<std::uint32_t> parents = {none}, objects = {none};
  for (std::uint32_t n = 1; n < 300; ++n) {
    parents.push_back(random.below(n));
    objects.push_back(random.below(3) == 0 ? none : random.below(50));
  }
  trees.push_back(ObjectTree::from_parents(parents, objects, 50));
  return trees;
}

TEST(TreeSection, KeepsAnyTree) {
  for (const ObjectTree& tree : assorted_trees()) {
    for (const bool nodes : {false, true}) {
      const auto [back, back_nodes] = tree_from_bytes(tree_bytes(tree, nodes));
      EXPECT_EQ(back, tree);
      EXPECT_EQ(back_nodes, nodes);
    }
  }
}

// A binary tree whose leaves stand in the order of their objects: its shape alone takes anything.
TEST(TreeSection, TakesAboutItsShapeAndAnOrder) {
  const ObjectTree even = test::even_tree(4000, 2);
  EXPECT_LT(tree_bytes(even, false).size(), 700u);  // 8000 nodes
  const Permutation shuffle = shuffled(4000, 4);
  std::vector<std::uint32_t> parents(even.parent_of_node().begin(), even.parent_of_node().end()),
      objects(even.object_of_node().begin(), even.object_of_node().end());
  for (std::uint32_t& object : objects)
    object = object == ObjectTree::none ? object : shuffle.new_of_old()[object];
  EXPECT_LT(tree_bytes(ObjectTree::from_parents(parents, objects, 4000), false).size(),
            permutation_bytes(4000) * 11 / 10 + 700);
}

TEST(TreeSection, HasOneCodeForEachTree) {
  for (const ObjectTree& tree : assorted_trees()) {
    if (tree.size() > 200) continue;  // a bit at a time
    expect_one_code(tree_bytes(tree, false), tree_from_bytes,
                    [](const auto& read) { return tree_bytes(read.first, read.second); });
  }
}

TEST(TreeSection, RefusesClaims) {
  std::vector<std::byte> bytes = {std::byte{0}};
  put_varint(bytes, 0xffffffff);
  put_varint(bytes, 0xfffffff0);
  EXPECT_THROW(tree_from_bytes(bytes), FormatError);
}

TEST(NameSection, HasOneCodeForTheNames) {
  const std::vector<std::string> names = {"", "wall 1", "wall 12", "wall", "", "\xc3\xa4", "wall 1"};
  expect_one_code(name_bytes(names), names_from_bytes, [](const auto& read) { return name_bytes(read); });
  EXPECT_EQ(names_from_bytes(name_bytes(names)), names);
}

// Long paths that differ at their ends are kept.
TEST(NameSection, KeepsLongNamesThatBeginAlike) {
  std::vector<std::string> names;
  for (int i = 0; i < 5000; ++i) names.push_back(std::string(600, 'p') + "/" + std::to_string(i));
  EXPECT_EQ(names_from_bytes(name_bytes(names)), names);
  EXPECT_THROW(name_bytes(std::vector<std::string>(2000, std::string(50000, 'p'))), std::invalid_argument);
}

// Each name repeats all of the one before: short bytes for 1 GB of names.
TEST(NameSection, RefusesNamesThatGrowWithoutBytes) {
  std::vector<std::byte> bytes;
  put_varint(bytes, 0);
  put_varint(bytes, 50000);
  bytes.resize(bytes.size() + 50000, std::byte{'a'});
  for (int i = 0; i < 20000; ++i)
    bytes.insert(bytes.end(), {std::byte{0xd0}, std::byte{0x86}, std::byte{3}, std::byte{0}});
  EXPECT_THROW(names_from_bytes(bytes), FormatError);
}

TEST(LevelSection, HasOneCodeForTheLevels) {
  const std::vector<ObjectLevel> levels = {{0, 0}, {0, 1}, {7, 3}, {0xffffffff, 0}, {0, 0xffffffff}};
  expect_one_code(level_bytes(levels), levels_from_bytes, [](const auto& read) { return level_bytes(read); });
  EXPECT_EQ(levels_from_bytes(level_bytes(levels)), levels);
}

TEST(BandSection, HasOneCodeForTheBands) {
  const std::vector<std::uint32_t> bands = {0, 1, 64, 99};
  expect_one_code(
      band_bytes(bands, 100), [](std::span<const std::byte> bytes) { return bands_from_bytes(bytes, 100); },
      [](const auto& read) { return band_bytes(read, 100); });
  EXPECT_EQ(bands_from_bytes(band_bytes(bands, 100), 100), bands);
  EXPECT_THROW(bands_from_bytes(band_bytes(bands, 100), 99), FormatError);
  for (const std::vector<std::uint32_t>& bad : {std::vector<std::uint32_t>{1}, {0, 0}, {0, 5, 4}, {0, 100}})
    EXPECT_THROW(band_bytes(bad, 100), std::invalid_argument);
}

}  // namespace
}  // namespace vismat
