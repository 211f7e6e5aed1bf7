// A partition of rows or columns into groups, as merging makes it.
#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "matrix/permutation.h"
#include "matrix/visibility_matrix.h"

namespace vismat {

/// Puts each of the members [0, size) into one of the groups [0, groups), none of which is empty; checked once, on
/// construction.
class Partition {
 public:
  Partition() = default;
  /// Each member is a group of its own.
  static Partition identity(std::uint32_t size);
  /// Throws std::invalid_argument, naming the group, if a group below the highest one has no member.
  static Partition from_group_of_member(std::vector<std::uint32_t> map);

  std::uint32_t size() const { return static_cast<std::uint32_t>(group_of_member_.size()); }
  std::uint32_t groups() const { return groups_; }
  std::span<const std::uint32_t> group_of_member() const { return group_of_member_; }
  /// A matrix of groups x members: row g lists the members of group g. O(size).
  VisibilityMatrix members() const;
  bool operator==(const Partition&) const = default;

 private:
  std::vector<std::uint32_t> group_of_member_;
  std::uint32_t groups_ = 0;
};

/// The partition of first's members that results if the groups of `first` are the members of `then`. Sizes must match.
Partition followed_by(const Partition& first, const Partition& then);
/// The same groups, renumbered: group g becomes group order.new_of_old()[g]. Sizes must match.
Partition renumbered(const Partition& groups, const Permutation& order);

/// Puts equal rows into one group. Groups are numbered in the order of their first rows. O(ones).
Partition equal_rows(const VisibilityMatrix& matrix);

/// One row for each group, the union of its members' rows: what none of them sees stays hidden [Zach & Karner 2003,
/// section 4.1; van de Panne & Stewart 1999]. rows.size() == matrix.shape().rows. O(ones).
VisibilityMatrix merge_rows(const VisibilityMatrix& matrix, const Partition& rows);
/// One column for each group, visible where any of its members is. O(ones).
VisibilityMatrix merge_columns(const VisibilityMatrix& matrix, const Partition& columns);
/// Gives every member the row of its group. O(the result's ones).
VisibilityMatrix expand_rows(const VisibilityMatrix& merged, const Partition& rows);
/// Gives every member the column of its group.
VisibilityMatrix expand_columns(const VisibilityMatrix& merged, const Partition& columns);

}  // namespace vismat
