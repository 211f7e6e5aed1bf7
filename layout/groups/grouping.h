// The table of groupings: methods that choose the rows to merge when some occlusions may be lost. Tests, benchmarks and
// the program loop over it. Columns are grouped as the rows of the transposed matrix.
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
  /// The number of occlusions (zeros of the matrix) that may be lost, each counted in every row that loses it.
  std::uint64_t lost = 0;
  /// The share of its own zeros that a single row may lose, so that no view cell pays for all.
  double lost_in_row = 1;
  /// The number of zeros that each column may lose; empty: any number. It does for view cells that are columns what
  /// lost_in_row does for rows.
  std::vector<std::uint32_t> room_in_column = {};
  std::uint64_t seed = 1;
  unsigned threads = 0;  // 0: one for each core; the groups do not depend on it
  Progress progress = {};
};

/// A grouping as a plain value. The groups' unions lose no more than the options allow; equal rows always share a
/// group.
struct Grouping {
  std::string_view name;
  std::string_view idea;
  Partition (*group_rows)(const VisibilityMatrix&, const GroupingOptions&);
};

std::span<const Grouping> groupings();
const Grouping& find_grouping(std::string_view name);  // throws std::invalid_argument that lists the names

/// The rows and columns of a matrix to merge; none on a side that is to stay.
struct MergeGroups {
  std::optional<Partition> rows, columns;
};
enum class MergeSide { rows, columns, both };
/// lost and lost_in_row hold for both sides together. With both sides, rows come first, for half of what may be lost,
/// then columns for the rest.
MergeGroups group_sides(const VisibilityMatrix& matrix, MergeSide side, const Grouping& grouping,
                        const GroupingOptions& options);

}  // namespace vismat
