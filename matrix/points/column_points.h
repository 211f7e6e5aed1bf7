// The columns of a matrix as points of a Hamming space, with which all tours and bounds work.
#pragma once
#include <bit>
#include <cstdint>
#include <vector>

#include "matrix/base/parallel.h"
#include "matrix/bit_rows.h"
#include "matrix/visibility_matrix.h"

namespace vismat {

/// Point i is column i as a bit vector over the rows; point size() is the zero point, the all-zero vector. A tour
/// through all of them that begins and ends at the zero point is twice as long as its order of columns has runs of
/// ones: each run begins where a column has a one that the column before has not, and ends likewise. Memory: rows *
/// columns / 8 bytes.
class ColumnPoints {
 public:
  explicit ColumnPoints(const VisibilityMatrix& matrix)
      : bits_(transpose(matrix)), ones_(bits_.shape().rows) {
    for (std::uint32_t i = 0; i < size(); ++i) {
      for (const std::uint64_t word : bits_.row(i))
        ones_[i] += static_cast<std::uint32_t>(std::popcount(word));
    }
  }
  std::uint32_t size() const { return bits_.shape().rows; }
  std::uint32_t rows() const { return bits_.shape().columns; }
  std::uint32_t zero() const { return size(); }
  /// Exact up to `limit`, otherwise some number above it.
  std::uint32_t distance(std::uint32_t a, std::uint32_t b, std::uint32_t limit = 0xffffffff) const {
    if (a >= size() || b >= size()) return a == b ? 0 : ones_[a < size() ? a : b];
    return hamming_distance(bits_.row(a), bits_.row(b), limit);
  }

 private:
  BitRows bits_;
  std::vector<std::uint32_t> ones_;
};

/// In lists of points and distances: no point there, or one too far to tell.
inline constexpr std::uint32_t no_point = 0xffffffff;

/// The k nearest other points of each point, nearest first, ties by number; the zero point is a point like any other.
struct NeighbourLists {
  std::uint32_t per_point = 0;
  std::vector<std::uint32_t> ids, distances;  // per_point for each of size() + 1 points
};

/// Computed from all pairs: columns^2 * rows / 64 word operations.
NeighbourLists exact_neighbours(const ColumnPoints& points, std::uint32_t k, unsigned threads = 0,
                                const Progress& progress = {});

}  // namespace vismat
