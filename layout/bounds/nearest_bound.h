// A proven lower bound on the number of runs of any order of columns, by exact nearest neighbours, for matrices with
// too many pairs of columns to look at all.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "matrix/points/column_points.h"
#include "matrix/points/sketch.h"
#include "matrix/points/sparse_points.h"

namespace vismat {

/// Lists of exact distances, and what they prove about all other pairs.
struct CertifiedNeighbours {
  NeighbourLists lists;  // points.size() points'; a distance of 0xffffffff ends a list
  std::vector<std::uint32_t>
      threshold;  // pairs in neither point's list are at least this far apart, for both points
};

struct CertifyOptions {
  std::uint32_t block = 16;    // points that are ruled out together
  std::uint64_t work = 10000;  // pairs examined singly for each point, on average over its block
  Stages stages = {};
};

/// Completes lists (of nearby_points, or of any true distances) by an exact search around each point, no farther than
/// its list's last distance. `visits` is an order of all points in which near points are mostly close to each other,
/// such as that of visits_at_scale: it decides the speed. Throws std::invalid_argument if `block` is 0. If `work` does
/// not suffice the threshold gets lower, but it stays true. Memory: 600 bytes for each point. The result is the same
/// with any number of threads.
CertifiedNeighbours certify_neighbours(const SparsePoints& points, const ColumnSketches& sketches,
                                       const NeighbourLists& lists, std::span<const std::uint32_t> visits,
                                       const CertifyOptions& options = {}, unsigned threads = 0);

/// A tour enters and leaves each point: no order of the columns has fewer runs than a quarter of the sum of the
/// distances from every point to its two nearest. Unlisted distances count as the threshold.
std::uint64_t two_nearest_bound(const SparsePoints& points, const CertifiedNeighbours& neighbours);

/// The whole computation, from an order of all points: its neighbours are where the exact search begins. Fails (is
/// slow, and then weak) if the nearest points are hardly nearer than all others, as in random columns.
std::uint64_t two_nearest_bound(const SparsePoints& points, std::span<const std::uint32_t> visits,
                                const CertifyOptions& options = {}, unsigned threads = 0);

}  // namespace vismat
