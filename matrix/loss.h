// Compares a merged (lossy) matrix with its source, here called the original, row by row: what it adds, and whether it
// hides anything that was visible.
#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "matrix/partition.h"
#include "matrix/visibility_matrix.h"

namespace vismat {

/// For one row: how many ones the original has, and how many only the lossy matrix has.
struct RowLoss {
  std::uint32_t visible = 0, added = 0;
  bool operator==(const RowLoss&) const = default;
};

struct Loss {
  Shape shape;
  std::uint64_t visible = 0;  // ones of the original
  /// Ones that only the lossy matrix has: the lost occlusions [Zach & Karner 2003, section 4.1].
  std::uint64_t added = 0;
  std::uint64_t missing = 0;  // ones that only the original has: 0 if nothing but occlusions was lost
  struct Entry {
    std::uint32_t row, column;
    bool operator==(const Entry&) const = default;
  };
  std::optional<Entry> first_missing;
  std::vector<RowLoss> rows;

  /// The zeros of the original.
  std::uint64_t hidden() const { return std::uint64_t{shape.rows} * shape.columns - visible; }
  /// The added ones as a share of the original's zeros (the paper's lost occlusions), and as a share of its ones. 0 if
  /// nothing was added.
  double lost() const;
  double added_share() const;
  /// The share of its zeros that the row lost.
  double lost_in(std::uint32_t row) const;
  /// The row that lost the greatest share of its own zeros, and the first of these if there are several. Needs a row.
  std::uint32_t worst_row() const;
};

/// Compares the two, which must be in the source's numbers. Throws std::invalid_argument if the shapes differ. O(ones
/// of both).
Loss loss_of(const VisibilityMatrix& lossy, const VisibilityMatrix& original);
/// The same for a lossy matrix that has one row for each group of rows. The groups' rows are never written out for each
/// member: at 5 % lost occlusions they can be many times the original.
Loss loss_of(const VisibilityMatrix& merged, const Partition& rows, const VisibilityMatrix& original);

}  // namespace vismat
