// The table of groupings: which rows to merge when some occlusion may be lost. Tests, benchmarks and the program loop over
// it. Columns are grouped as the rows of the transposed matrix.
#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "matrix/base/parallel.h"
#include "matrix/partition.h"
#include "matrix/visibility_matrix.h"

namespace vismat {

struct GroupingOptions {
  /// How many occlusions (zeros of the matrix) may be lost, each counted in every row that loses it.
  std::uint64_t lost = 0;
  /// The share of its own zeros that a single row may lose, so that no view cell pays for all.
  double lost_in_row = 1;
  /// How many zeros each column may lose; empty: any. What lost_in_row is to the rows where these are the columns.
  std::vector<std::uint32_t> room_in_column = {};
  std::uint64_t seed = 1;
  unsigned threads = 0;  // 0: one a core; the groups do not depend on it
  Progress progress = {};
};

/// A plain value. The groups' unions lose no more than the options allow; equal rows always share a group.
struct Grouping {
  std::string_view name;
  std::string_view idea;
  Partition (*group_rows)(const VisibilityMatrix&, const GroupingOptions&);
};

std::span<const Grouping> groupings();
const Grouping& find_grouping(std::string_view name);  // throws std::invalid_argument that lists the names

/// Which rows and columns of a matrix to merge; none of a side that is to stay.
struct MergeGroups {
  std::optional<Partition> rows, columns;
};
enum class MergeSide { rows, columns, both };
/// lost and lost_in_row hold for both sides together. Both: rows first, for half of what may be lost, then columns for
/// the rest.
MergeGroups group_sides(const VisibilityMatrix& matrix, MergeSide side, const Grouping& grouping,
                        const GroupingOptions& options);

}  // namespace vismat
