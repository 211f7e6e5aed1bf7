// All distances between columns, a row of their table at a time.
#pragma once
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "layout/points/sparse_points.h"
#include "matrix/bit_rows.h"

namespace vismat {

/// A distance of more than that is told as that: a lower bound all the same.
using Distance16 = std::uint16_t;

/// The square table of the points' distances, the zero point not among them. Kept where it takes no more than
/// `most_bytes`, 2 for each pair; else made anew each time it is read. A row is made from dense bits or from
/// an inverted index, whichever is cheaper: columns * rows / 64 word operations, or an addition for each two
/// ones that share a row of the matrix with it.
class PairDistances {
 public:
  explicit PairDistances(const SparsePoints& points, std::uint64_t most_bytes = std::uint64_t{2} << 30,
                         unsigned threads = 0);

  std::uint32_t size() const { return points_.size(); }
  bool kept() const { return !table_.empty(); }
  /// Told each point with its distances to all, on several threads, in no fixed order.
  using Take = std::function<void(std::uint32_t, std::span<const Distance16>)>;
  void each_row(const Take& take, unsigned threads = 0) const;

 private:
  void make_rows(const Take& take, unsigned threads) const;

  const SparsePoints& points_;
  BitRows bits_;                             // if that is the cheaper way,
  std::vector<std::uint64_t> first_of_row_;  // else the points with a one in each row
  std::vector<std::uint32_t> points_of_row_;
  std::vector<Distance16> table_;
};

}  // namespace vismat
