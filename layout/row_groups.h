// Rows that are being merged: their unions, and what merging two more would lose.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "layout/grouping.h"
#include "matrix/bit_rows.h"
#include "matrix/partition.h"

namespace vismat {

/// Groups are numbered by one of their members, which stays as others join it. Equal rows are one group from the start.
/// Memory: rows * columns / 8 bytes and some 100 a row.
class RowGroups {
 public:
  RowGroups(const VisibilityMatrix& matrix, const GroupingOptions& options);

  static constexpr std::uint32_t none = 0xffffffff;
  static constexpr std::uint64_t unbounded = ~std::uint64_t{0};
  struct Pair {
    std::uint64_t score = unbounded;
    std::uint32_t partner = none;
  };

  /// Ascending at first, then in no order.
  std::span<const std::uint32_t> alive() const { return alive_; }
  bool is_alive(std::uint32_t group) const { return place_[group] != none; }
  /// Occlusions that merging the two would lose: members of a times what b has alone, and the other way round [Zach & Karner
  /// 2003, 4.1]. A number above `limit` as soon as it is known to be above, or where a member would lose too many.
  std::uint64_t score(std::uint32_t a, std::uint32_t b, std::uint64_t limit = unbounded) const;
  /// The group of the least score with this one; of equal ones the least number. Only groups whose sizes are near enough are
  /// looked at [Zach & Karner 2003, 4.1].
  Pair best_partner(std::uint32_t group) const;
  /// The second becomes part of the first.
  void merge(std::uint32_t into, std::uint32_t from);
  /// Groups in the order of their first members.
  Partition partition() const;

 private:
  bool has_room(std::uint32_t a, std::uint32_t b) const;
  void insert(std::uint32_t group);
  void remove(std::uint32_t group);

  BitRows bits_;
  std::vector<std::uint32_t> size_, members_;  // of each group's union; of the group
  std::vector<std::uint32_t> most_;            // ones that the union may have before some member loses too many
  std::vector<std::uint32_t> room_;            // zeros that each column may still lose; empty: any
  std::vector<std::uint32_t> group_of_row_;
  std::vector<std::uint32_t> alive_, place_;
  std::vector<std::vector<std::uint32_t>> of_size_;  // groups by their unions' sizes
  std::vector<std::uint32_t> place_in_size_;
};

}  // namespace vismat
