#include "layout/groups/grouping.h"

#include <array>
#include <stdexcept>
#include <string>

#include "layout/groups/pair_grouping.h"
#include "layout/groups/seed_grouping.h"

namespace vismat {
namespace {

// Of what may be lost on both sides, what rows take.
constexpr double rows_share = 0.5;

constexpr std::array table = {
    Grouping{"seeds", "merge random members with their best partners [Zach & Karner 2003]",
             [](const VisibilityMatrix& m, const GroupingOptions& o) { return group_rows_by_seeds(m, o); }},
    Grouping{"pairs", "merge the best of all pairs, then move members to better groups",
             [](const VisibilityMatrix& m, const GroupingOptions& o) { return group_rows_by_pairs(m, o); }},
};

}  // namespace

std::span<const Grouping> groupings() {
  return table;
}

const Grouping& find_grouping(std::string_view name) {
  std::string names;
  for (const Grouping& grouping : table) {
    if (grouping.name == name) return grouping;
    names += (names.empty() ? "" : ", ") + std::string(grouping.name);
  }
  throw std::invalid_argument("'" + std::string(name) + "' is no grouping method; there are " + names);
}

MergeGroups group_sides(const VisibilityMatrix& matrix, MergeSide side, const Grouping& grouping,
                        const GroupingOptions& options) {
  MergeGroups groups;
  VisibilityMatrix present = matrix;
  GroupingOptions of_columns = options;
  if (side != MergeSide::columns) {
    GroupingOptions of_rows = options;
    if (side == MergeSide::both)
      of_rows.lost = static_cast<std::uint64_t>(static_cast<double>(options.lost) * rows_share);
    groups.rows = grouping.group_rows(matrix, of_rows);
    if (side == MergeSide::rows) return groups;
    present = expand_rows(merge_rows(matrix, *groups.rows), *groups.rows);
    of_columns.lost = options.lost - (present.ones() - matrix.ones());
  }
  if (options.lost_in_row < 1) {
    for (std::uint32_t r = 0; r < matrix.shape().rows; ++r) {
      const std::size_t visible = matrix.row(r).size();
      const double hidden = static_cast<double>(matrix.shape().columns - visible);
      const auto lost = static_cast<std::uint32_t>(present.row(r).size() - visible);
      of_columns.room_in_column.push_back(static_cast<std::uint32_t>(options.lost_in_row * hidden) - lost);
    }
  }
  of_columns.lost_in_row = 1;
  groups.columns = grouping.group_rows(transpose(present), of_columns);
  return groups;
}

}  // namespace vismat
