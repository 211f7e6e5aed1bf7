// Groups of rows that are being merged: their unions, and what merging two more would lose.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "layout/groups/grouping.h"
#include "matrix/bit_rows.h"
#include "matrix/partition.h"

namespace vismat {

/// Equal rows count as one distinct row and never separate. At first each distinct row is a group; a group keeps its
/// number when others join it. Memory: rows * columns / 8 bytes and 64 for each row.
class RowGroups {
 public:
  RowGroups(const VisibilityMatrix& matrix, const GroupingOptions& options);

  static constexpr std::uint32_t none = 0xffffffff;
  static constexpr std::uint64_t unbounded = ~std::uint64_t{0};
  struct Pair {
    std::uint64_t score = unbounded;
    std::uint32_t partner = none;
  };

  /// The groups that exist. Ascending at first, later in no order.
  std::span<const std::uint32_t> alive() const { return alive_; }
  bool is_alive(std::uint32_t group) const { return place_[group] != none; }
  /// The occlusions that are lost so far.
  std::uint64_t lost() const { return lost_; }
  /// The number of occlusions that merging the two groups would lose: rows of a times what only b has, and the other
  /// way round [Zach & Karner 2003, section 4.1]. Unbounded if that is above `limit`, or if some row or column would
  /// lose more than it may.
  std::uint64_t score(std::uint32_t a, std::uint32_t b, std::uint64_t limit = unbounded) const;
  /// The group with the least score with this one; of equal ones the lowest number. Only groups of similar size are
  /// examined [Zach & Karner 2003, section 4.1]. Groups of near rows are examined first, as near rows are often
  /// similar, and a low score soon rules the others out.
  Pair best_partner(std::uint32_t group) const;
  /// The second becomes part of the first. Their score must be bounded.
  void merge(std::uint32_t into, std::uint32_t from);
  /// Moves each distinct row in turn, where that regains occlusions, to the group where it regains most. Returns how
  /// many in all. O(distinct rows * groups * columns / 64) word operations at worst. Memory: groups * columns * 4 bytes
  /// meanwhile.
  std::uint64_t exchange();
  /// Groups in the order of their first members.
  Partition partition() const;

 private:
  struct Lost;
  bool has_room(std::span<const std::uint64_t> a, std::uint64_t in_a, std::span<const std::uint64_t> b,
                std::uint64_t in_b) const;
  void take_room(std::span<const std::uint64_t> a, std::uint64_t in_a, std::span<const std::uint64_t> b,
                 std::uint64_t in_b);
  void set_size(std::uint32_t group, std::uint32_t size);
  void fold(std::uint32_t group);

  Partition kind_of_row_;
  VisibilityMatrix kinds_;                                  // one row for each kind
  std::vector<std::uint32_t> rows_of_kind_, most_of_kind_;  // ones that its group's union may have
  std::vector<std::uint32_t> group_of_kind_;
  std::vector<std::uint32_t> room_;  // zeros that each column may still lose; empty: any
  std::uint64_t lost_ = 0;

  // By group.
  BitRows union_,
      folded_;  // the union's words folded by exclusive or into a cache line; its distances are never larger
  std::vector<std::uint32_t> size_, rows_, most_;  // the union's ones; rows; the least most_of_kind_
  std::vector<std::vector<std::uint32_t>> members_;
  std::vector<std::uint32_t> alive_, place_;
  std::vector<std::vector<std::uint32_t>> of_size_;  // groups by their unions' sizes
  std::vector<std::uint32_t> place_in_size_;
};

}  // namespace vismat
