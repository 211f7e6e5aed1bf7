// The distances of all pairs of columns, a row of their table at a time.
#pragma once
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "layout/points/sparse_points.h"
#include "matrix/bit_rows.h"

namespace vismat {

/// A distance that is larger than the type is stored as its largest number, which is still a lower bound.
using Distance16 = std::uint16_t;

/// The square table of the points' distances, without the zero point. It is kept if it takes no more than `most_bytes`,
/// 2 for each pair; otherwise it is computed anew each time it is read. A row is computed from dense bits or from an
/// inverted index, whichever is cheaper: columns * rows / 64 word operations, or one addition for each two ones of two
/// columns in the same row of the matrix.
class PairDistances {
 public:
  explicit PairDistances(const SparsePoints& points, std::uint64_t most_bytes = std::uint64_t{2} << 30,
                         unsigned threads = 0);

  std::uint32_t size() const { return points_.size(); }
  bool kept() const { return !table_.empty(); }
  /// Is called for each point with its distances to all points, on several threads, in no fixed order.
  using Take = std::function<void(std::uint32_t, std::span<const Distance16>)>;
  void each_row(const Take& take, unsigned threads = 0) const;

 private:
  void make_rows(const Take& take, unsigned threads) const;

  const SparsePoints& points_;
  BitRows bits_;                             // if bits are cheaper;
  std::vector<std::uint64_t> first_of_row_;  // otherwise the points with a one in each row
  std::vector<std::uint32_t> points_of_row_;
  std::vector<Distance16> table_;
};

}  // namespace vismat
