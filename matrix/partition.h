// A partition of rows or columns into groups, as a lossy merge makes it, with the map back to what was merged.
#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "matrix/permutation.h"
#include "matrix/visibility_matrix.h"

namespace vismat {

/// Members [0, size) in groups [0, groups), none of them empty; checked once on construction.
class Partition {
 public:
  Partition() = default;
  /// Each member alone.
  static Partition identity(std::uint32_t size);
  /// Throws std::invalid_argument, naming the group, if one below the greatest has no member.
  static Partition from_group_of_member(std::vector<std::uint32_t> map);

  std::uint32_t size() const { return static_cast<std::uint32_t>(group_of_member_.size()); }
  std::uint32_t groups() const { return groups_; }
  std::span<const std::uint32_t> group_of_member() const { return group_of_member_; }
  /// Groups x members: row g lists the members of g. O(size).
  VisibilityMatrix members() const;
  bool operator==(const Partition&) const = default;

 private:
  std::vector<std::uint32_t> group_of_member_;
  std::uint32_t groups_ = 0;
};

/// The groups of `first` become members of `then`. Sizes must match.
Partition followed_by(const Partition& first, const Partition& then);
/// Group g becomes group order.new_of_old()[g]. Sizes must match.
Partition renumbered(const Partition& groups, const Permutation& order);

/// Equal rows in one group, numbered in the order of their first ones. O(ones).
Partition equal_rows(const VisibilityMatrix& matrix);

/// A row a group, the union of its members' rows: what none of them sees stays hidden [Zach & Karner 2003, 4.1; van de Panne &
/// Stewart 1999]. rows.size() == matrix.shape().rows. O(ones).
VisibilityMatrix merge_rows(const VisibilityMatrix& matrix, const Partition& rows);
/// A column a group, visible where any of its members is. O(ones).
VisibilityMatrix merge_columns(const VisibilityMatrix& matrix, const Partition& columns);
/// Every member sees what its group's row tells. O(the result's ones).
VisibilityMatrix expand_rows(const VisibilityMatrix& merged, const Partition& rows);
/// Every member is visible where its group's column is.
VisibilityMatrix expand_columns(const VisibilityMatrix& merged, const Partition& columns);

}  // namespace vismat
