// Sketches: short bit vectors in place of long sparse columns, and the nearest points found with them.
#pragma once
#include <bit>
#include <cstdint>
#include <span>

#include "matrix/base/parallel.h"
#include "matrix/bit_rows.h"
#include "matrix/points/column_points.h"
#include "matrix/points/sparse_points.h"

namespace vismat {

/// The sketch of a point: its rows folded onto `bits` bits by exclusive or, the same way for all points. Folding never
/// increases a Hamming distance, so lower_bound() is valid. The zero point has a sketch like any other. Memory: bits /
/// 8 bytes for each point.
class ColumnSketches {
 public:
  /// `bits` is a power of two, at least 64; otherwise throws std::invalid_argument. 0: the next power of two above four
  /// times the mean weight, within [512, 8192].
  explicit ColumnSketches(const SparsePoints& points, std::uint32_t bits = 0, unsigned threads = 0);

  /// Never above the points' distance. Any number above `limit` as soon as it is known to be above.
  std::uint32_t lower_bound(std::uint32_t a, std::uint32_t b, std::uint32_t limit = 0xffffffff) const {
    return hamming_distance(bits_.row(a), bits_.row(b), limit);
  }
  std::uint32_t bits() const { return bits_.shape().columns; }

 private:
  BitRows bits_;
};

struct NearbyOptions {
  std::uint32_t neighbours = 10;  // a point
  std::uint32_t tables = 8;       // sorts by min-hash
  std::uint32_t window = 5;       // candidates on each side of a point in each
  std::uint32_t rounds = 1;       // of examining the neighbours' neighbours
  std::uint32_t lacked = 1;       // as NearOptions has it
  std::uint64_t seed = 1;
  Stages stages = {};
};

/// The near points of each point: candidates by min-hash, of which the best by sketch are kept, then neighbours of
/// neighbours; the distances of the result are exact. per_point is less than `neighbours` only if there are fewer other
/// points; a list that found fewer ends with distance 0xffffffff. The same seed gives the same lists with any number of
/// threads. The source gives the measured recall. Fails if near columns have few ones in common (small or nearly random
/// columns): use exact_neighbours there.
NeighbourLists nearby_points(const SparsePoints& points, const ColumnSketches& sketches,
                             const NearbyOptions& options = {}, unsigned threads = 0);

/// Sorts points by a min-hash signature, `tables` times, so that columns with many ones in common are often close to
/// each other: each table is an order of all of `members`. Deterministic.
std::vector<std::vector<std::uint32_t>> min_hash_orders(const SparsePoints& points,
                                                        std::span<const std::uint32_t> members,
                                                        std::uint32_t tables, std::uint64_t seed,
                                                        unsigned threads = 0);

}  // namespace vismat
