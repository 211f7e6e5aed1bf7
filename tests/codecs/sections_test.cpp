#include "codecs/sections.h"

#include <algorithm>
#include <bit>

#include <gtest/gtest.h>

#include "codecs/baseline_codecs.h"
#include "codecs/container.h"
#include "codecs/row_reader.h"
#include "matrix/byte_reader.h"
#include "matrix/random.h"
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
      EXPECT_EQ(group_bytes(read), bad) << bit;
    } catch (const FormatError&) {
    }
  }
}

TEST(GroupSection, StandsInPlaceOfAnOrder) {
  Container container = compress(test::clustered_matrix({20, 30}, 4), find_codec("delimiter"));
  std::vector<std::uint32_t> groups(50);
  for (std::uint32_t m = 0; m < 50; ++m) groups[m] = (m * 7) % 20;
  container.row_groups = Partition::from_group_of_member(groups);
  container.column_groups = Partition::identity(30);
  const auto file = write_container(container);
  const RowReader reader(file);
  EXPECT_EQ(reader.row_groups(), container.row_groups);
  EXPECT_EQ(reader.column_groups(), container.column_groups);
  EXPECT_EQ(reader.row_order(), std::nullopt);
  container.row_order = Permutation::identity(20);
  EXPECT_THROW(read_container(write_container(container)), FormatError);
}

}  // namespace
}  // namespace vismat
