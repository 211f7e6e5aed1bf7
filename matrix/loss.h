// Compares a lossy matrix with its original, row by row: what it adds, and whether it hides anything that was visible.
#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "matrix/visibility_matrix.h"

namespace vismat {

/// Of one row: what the original has visible, and what is visible in the lossy matrix alone.
struct RowLoss {
  std::uint32_t visible = 0, added = 0;
  bool operator==(const RowLoss&) const = default;
};

struct Loss {
  Shape shape;
  std::uint64_t visible = 0;  // ones of the original
  std::uint64_t added = 0;    // ones of the lossy matrix alone: lost occlusions [Zach & Karner 2003, 4.1]
  std::uint64_t missing = 0;  // ones of the original alone: nothing may be lost but occlusions
  struct Entry {
    std::uint32_t row, column;
    bool operator==(const Entry&) const = default;
  };
  std::optional<Entry> first_missing;
  std::vector<RowLoss> rows;

  /// Zeros of the original.
  std::uint64_t hidden() const { return std::uint64_t{shape.rows} * shape.columns - visible; }
  /// Added ones as a share of the zeros that there were, which is the paper's lost occlusions, and of the ones. 0 where
  /// nothing was added.
  double lost() const;
  double added_share() const;
  /// The share of its zeros that one row lost.
  double lost_in(std::uint32_t row) const;
  /// The row that lost the greatest share of its own zeros; the first of several. Needs a row.
  std::uint32_t worst_row() const;
};

/// Both as their source numbers them. Throws std::invalid_argument where the shapes differ. O(ones of both).
Loss loss_of(const VisibilityMatrix& lossy, const VisibilityMatrix& original);

}  // namespace vismat
