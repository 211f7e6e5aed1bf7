// Short sketches of long sparse columns, and the nearest points found by way of them.
#pragma once
#include <bit>
#include <cstdint>
#include <span>

#include "layout/points/column_points.h"
#include "layout/points/sparse_points.h"
#include "matrix/base/parallel.h"
#include "matrix/bit_rows.h"

namespace vismat {

/// Rows folded onto `bits` bits by exclusive or, the same way for all points. Folding never increases a
/// Hamming distance, so lower_bound() is one. The zero point has a sketch like any other. Memory: bits / 8
/// bytes a point.
class ColumnSketches {
 public:
  /// `bits` is a power of two, at least 64; 0: the next one above four times the mean weight, in [512, 8192].
  /// Throws std::invalid_argument otherwise.
  explicit ColumnSketches(const SparsePoints& points, std::uint32_t bits = 0, unsigned threads = 0);

  /// Never above the points' distance; some number above `limit` as soon as it is known to be above.
  std::uint32_t lower_bound(std::uint32_t a, std::uint32_t b, std::uint32_t limit = 0xffffffff) const {
    return hamming_distance(bits_.row(a), bits_.row(b), limit);
  }
  std::uint32_t bits() const { return bits_.shape().columns; }

 private:
  BitRows bits_;
};

struct NearbyOptions {
  std::uint32_t neighbours = 10;  // a point
  std::uint32_t tables = 8;       // min-hash sorts
  std::uint32_t window = 5;       // candidates to either side of a point in each
  std::uint32_t rounds = 1;       // of asking the neighbours' neighbours
  std::uint64_t seed = 1;
  Stages stages = {};
};

/// Near points of each: candidates by min-hash, the best of them by sketch, then neighbours of neighbours; of
/// those, exact distances. per_point is less than `neighbours` only where there are fewer other points; a
/// list that found fewer ends in distance 0xffffffff. Same seed, same lists, for any thread count. Recall is
/// measured in the source; it breaks where near columns share few ones (small or nearly random columns): use
/// exact_neighbours there.
NeighbourLists nearby_points(const SparsePoints& points, const ColumnSketches& sketches,
                             const NearbyOptions& options = {}, unsigned threads = 0);

/// Sorts points by a min-hash signature, `tables` times, so that columns with many ones in common often stand
/// near each other: each table is an order of all of `members`. Deterministic.
std::vector<std::vector<std::uint32_t>> min_hash_orders(const SparsePoints& points,
                                                        std::span<const std::uint32_t> members,
                                                        std::uint32_t tables, std::uint64_t seed,
                                                        unsigned threads = 0);

}  // namespace vismat
