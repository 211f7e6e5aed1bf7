// A proven lower bound on the runs of any order of columns, where all pairs are too many: by exact nearest neighbours.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "layout/points/column_points.h"
#include "layout/points/sketch.h"
#include "layout/points/sparse_points.h"

namespace vismat {

/// Lists of exact distances, and what is known of all other pairs.
struct CertifiedNeighbours {
  NeighbourLists lists;  // points.size() points'; a distance of 0xffffffff ends a list
  std::vector<std::uint32_t>
      threshold;  // pairs in neither point's list are at least this far apart, for both points
};

struct CertifyOptions {
  std::uint32_t block = 16;    // points that are ruled out together
  std::uint64_t work = 10000;  // pairs looked at one by one for each point, on average over its block
  Stages stages = {};
};

/// Completes lists (of nearby_points, or of any true distances) by an exact search around each point, no
/// further than its list's last distance. `visits` is an order of all points in which near ones mostly stand
/// together, as of visits_at_scale: it decides the speed. Throws std::invalid_argument if blocks hold
/// nothing. What `work` cannot reach lowers the threshold, never its truth. Memory: 600 bytes a point. Same
/// result for any thread count.
CertifiedNeighbours certify_neighbours(const SparsePoints& points, const ColumnSketches& sketches,
                                       const NeighbourLists& lists, std::span<const std::uint32_t> visits,
                                       const CertifyOptions& options = {}, unsigned threads = 0);

/// Each point is left and entered: no order of the columns has fewer runs than a quarter of the distances to
/// every point's two nearest, unlisted ones at the threshold.
std::uint64_t two_nearest_bound(const SparsePoints& points, const CertifiedNeighbours& neighbours);

/// All of it, from an order of all points: its neighbours are where the exact search begins. Breaks (goes
/// slow, and then weak) where the nearest are hardly nearer than all others, as in random columns.
std::uint64_t two_nearest_bound(const SparsePoints& points, std::span<const std::uint32_t> visits,
                                const CertifyOptions& options = {}, unsigned threads = 0);

}  // namespace vismat
