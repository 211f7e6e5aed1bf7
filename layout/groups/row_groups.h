// Groups of rows that are being merged: their unions, and what merging two more would lose.
#pragma once
#include <compare>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "layout/groups/group_sets.h"
#include "layout/groups/grouping.h"
#include "matrix/partition.h"

namespace vismat {

/// Equal rows count as one distinct row and never separate. At first each distinct row is a group; a group keeps its
/// number when others join it. Memory: rows * columns / 8 bytes, or at most 12 for each one of sparse rows (GroupSets),
/// and 64 for each row. The form changes the time and never a result.
class RowGroups {
 public:
  RowGroups(const VisibilityMatrix& matrix, const GroupingOptions& options,
            std::optional<GroupSets::Form> form = {});
  RowGroups(const RowGroups&) = delete;
  RowGroups& operator=(const RowGroups&) = delete;

  static constexpr std::uint32_t none = 0xffffffff;
  static constexpr std::uint64_t unbounded = ~std::uint64_t{0};
  struct Pair {
    std::uint64_t score = unbounded;
    std::uint32_t partner = none;
    auto operator<=>(const Pair&) const = default;
  };

  /// The groups that exist. Ascending at first, later in no order.
  std::span<const std::uint32_t> alive() const { return alive_; }
  /// The sets are kept as lists.
  bool sparse() const { return sets_.listed(); }
  /// While there is no index, merges take a fraction of the time, and best_partners looks at all sets. Only if sparse();
  /// exchange() needs it.
  void drop_index() { sets_.drop_index(); }
  void make_index() { sets_.make_index(); }
  bool indexed() const { return sets_.indexed(); }
  bool is_alive(std::uint32_t group) const { return place_[group] != none; }
  /// The occlusions that are lost so far.
  std::uint64_t lost() const { return lost_; }
  /// The number of occlusions that merging the two groups would lose: rows of a times what only b has, and the other
  /// way round [Zach & Karner 2003, section 4.1]. Unbounded if that is above `limit`, or if some row or column would
  /// lose more than it may.
  std::uint64_t score(std::uint32_t a, std::uint32_t b, std::uint64_t limit = unbounded) const;
  /// The groups with the least scores with this one, at most `most`, the least first, of equal ones the lowest number.
  /// A long search among sparse rows uses up to so many threads.
  std::vector<Pair> best_partners(std::uint32_t group, std::uint32_t most, unsigned threads = 1) const;
  /// The first of them; its partner is none if there is none.
  Pair best_partner(std::uint32_t group) const {
    const std::vector<Pair> best = best_partners(group, 1);
    return best.empty() ? Pair{} : best.front();
  }
  /// The same among the groups that these distinct rows are in now. Only if sparse().
  std::vector<Pair> best_among(std::uint32_t group, std::span<const std::uint32_t> kinds,
                               std::uint32_t most) const;
  /// The distinct rows, by the groups' numbers at first.
  const VisibilityMatrix& kinds() const { return kinds_; }
  /// The second becomes part of the first. Their score must be bounded.
  void merge(std::uint32_t into, std::uint32_t from);
  /// Moves each distinct row in turn, where that regains occlusions, to the group where it regains most. Returns how
  /// many in all. With bits O(distinct rows * groups * columns / 64) word operations at worst; with lists, one addition
  /// for each group that has a column of a row, and O(distinct rows * groups). Memory: see GroupSets::begin_moves.
  std::uint64_t exchange();
  /// Groups in the order of their first members.
  Partition partition() const;

 private:
  struct Lost;
  class Best;
  void search_by_size(std::uint32_t group, Best& best) const;
  void look_at(std::uint32_t group, std::uint32_t other, std::uint64_t shared, Best& best) const;
  template <typename Count>
  void search_by_index(std::uint32_t group, Best& best, unsigned threads) const;
  void search_among(std::uint32_t group, std::span<const std::uint32_t> others, Best& best) const;
  Pair best_home(std::uint32_t kind, std::uint64_t regained) const;
  template <typename DistanceTo>
  Pair best_home(std::uint32_t kind, std::uint64_t regained, const DistanceTo& distance_to) const;
  bool has_room(std::uint32_t a, std::uint32_t b) const;
  void take_room(std::uint32_t a, std::uint32_t b);
  void set_size(std::uint32_t group, std::uint32_t size);

  Partition kind_of_row_;
  VisibilityMatrix kinds_;                                  // one row for each kind
  std::vector<std::uint32_t> rows_of_kind_, most_of_kind_;  // ones that its group's union may have
  std::vector<std::uint32_t> group_of_kind_;
  std::vector<std::uint32_t> room_;  // zeros that each column may still lose; empty: any
  std::uint64_t lost_ = 0;

  // By group.
  GroupSets sets_;
  std::vector<std::uint32_t> rows_, most_;  // how many rows; the least most_of_kind_
  std::vector<std::vector<std::uint32_t>> members_;
  std::vector<std::uint32_t> alive_, place_;
  std::vector<std::vector<std::uint32_t>>
      of_size_;  // groups by their unions' sizes, as they are kept in step
  std::vector<std::uint32_t> size_, place_in_size_;
};

}  // namespace vismat
