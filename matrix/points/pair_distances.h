// The distances of all pairs of columns, a row of their table at a time.
#pragma once
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "matrix/points/point_comparison.h"
#include "matrix/points/sparse_points.h"

namespace vismat {

/// A distance that is larger than the type is stored as its largest number, which is still a lower bound.
using Distance16 = std::uint16_t;

/// The square table of the points' distances, without the zero point. It is kept if it takes no more than `most_bytes`,
/// 2 for each pair; otherwise it is computed anew each time it is read, as PointComparison does.
class PairDistances {
 public:
  explicit PairDistances(const SparsePoints& points, std::uint64_t most_bytes = std::uint64_t{2} << 30,
                         unsigned threads = 0);

  std::uint32_t size() const { return size_; }
  bool kept() const { return !table_.empty(); }
  /// Is called for each point with its distances to all points, on several threads, in no fixed order.
  using Take = std::function<void(std::uint32_t, std::span<const Distance16>)>;
  void each_row(const Take& take, unsigned threads = 0) const;

 private:
  std::uint32_t size_;
  std::optional<PointComparison> comparison_;  // if the table is not kept
  std::vector<Distance16> table_;
};

}  // namespace vismat
