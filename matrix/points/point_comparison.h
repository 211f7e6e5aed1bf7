// The distances of points to all others, from bits or from an inverted index.
#pragma once
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "matrix/base/parallel.h"
#include "matrix/bit_rows.h"
#include "matrix/points/inverted_index.h"
#include "matrix/points/sparse_points.h"

namespace vismat {

/// The estimate for all pairs of the points.
AllPairsCost all_pairs_cost(const SparsePoints& points);

/// Computes the distances of a point to all points but the zero point from dense bits or from an inverted index,
/// whichever is cheaper for all pairs (all_pairs_cost). Memory: rows / 8 bytes for each point, or 4 for each one. The
/// points must outlive it.
class PointComparison {
 public:
  explicit PointComparison(const SparsePoints& points);

  std::uint32_t size() const { return points_.size(); }
  /// distances[q] becomes the distance of points p and q, for all size() points q.
  void distances_of(std::uint32_t p, std::vector<std::uint32_t>& distances) const;
  /// Is called for each point with its distances to all points, on several threads, in no fixed order.
  using Take = std::function<void(std::uint32_t, std::span<const std::uint32_t>)>;
  void each_row(const Take& take, unsigned threads = 0, const Progress& progress = {}) const;

 private:
  const SparsePoints& points_;
  std::vector<std::uint32_t> weights_;
  BitRows bits_;         // if bits are cheaper,
  InvertedIndex index_;  // otherwise
  bool indexed_ = true, wide_ = false;
};

}  // namespace vismat
