// Rows that are coded under one another, while an encoder chooses who stands under whom.
#pragma once
#include <algorithm>
#include <cstdint>
#include <vector>

#include "codecs/modelled/row_references.h"

namespace vismat {

/// Each row has a reference, or none. Borrows the run ends.
class RowForest {
 public:
  RowForest(const RowEnds& ends, const RowWeights& weights)
      : ends_(ends), weights_(weights), parent_(ends.rows(), no_row), time_(ends.rows()) {}
  std::uint32_t rows() const { return ends_.rows(); }
  std::uint32_t parent(std::uint32_t row) const { return row == no_row ? no_row : parent_[row]; }
  std::uint32_t columns() const { return ends_.columns(); }
  double time(std::uint32_t row) const { return time_[row]; }  // of decoding this row alone
  Ends ends(std::uint32_t row) const { return ends_[row == no_row ? ends_.rows() : row]; }
  RowCost cost(std::uint32_t row, std::uint32_t a, std::uint32_t b) const {
    return cost_of_row(ends(a), ends(b), ends(row), ends_.columns(), weights_);
  }
  RowCost cost(std::uint32_t row, std::uint32_t reference) const {
    return cost(row, reference, parent(reference));
  }
  void hang(std::uint32_t row, std::uint32_t reference) { parent_[row] = reference; }
  /// Takes the time of the row where it hangs now, and returns what it costs there.
  RowCost price(std::uint32_t row) {
    const RowCost there = cost(row, parent_[row]);
    time_[row] = there.microseconds;
    return there;
  }
  bool below(std::uint32_t row, std::uint32_t ancestor) const {
    for (; row != no_row; row = parent_[row]) {
      if (row == ancestor) return true;
    }
    return false;
  }
  /// Of each row, and of no_row at the end, ascending.
  std::vector<std::vector<std::uint32_t>> children() const {
    std::vector<std::vector<std::uint32_t>> all(rows() + std::size_t{1});
    for (std::uint32_t r = 0; r < rows(); ++r) all[std::min(parent_[r], rows())].push_back(r);
    return all;
  }

 private:
  const RowEnds& ends_;
  const RowWeights& weights_;
  std::vector<std::uint32_t> parent_;
  std::vector<double> time_;
};

}  // namespace vismat
