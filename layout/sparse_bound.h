// Proven lower bounds on the runs of any order of columns, where all pairs are too many.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "layout/column_points.h"
#include "layout/sketch.h"
#include "layout/sparse_points.h"

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
};

/// Completes lists (of nearby_points, or of any true distances) by an exact search around each point, no
/// further than its list's last distance. `visits` is an order of all points in which near ones mostly stand
/// together, as of visits_at_scale: it decides the speed. Throws std::invalid_argument if blocks hold
/// nothing. What `work` cannot reach lowers the threshold, never its truth. Memory: 600 bytes a point. Same
/// result for any thread count.
CertifiedNeighbours certify_neighbours(const SparsePoints& points, const ColumnSketches& sketches,
                                       const NeighbourLists& lists, std::span<const std::uint32_t> visits,
                                       const CertifyOptions& options = {}, unsigned threads = 0);

/// Each point is left and entered: a quarter of the distances to its two nearest, unlisted ones at the
/// threshold.
std::uint64_t two_nearest_bound(const SparsePoints& points, const CertifiedNeighbours& neighbours);

struct SparseBoundOptions {
  std::uint32_t steps = 100;
  /// Runs of a known order, if any: sets the length of the steps, never the validity of the bound.
  std::uint64_t known_runs = 0;
};

struct SparseBound {
  std::uint64_t runs = 0;              // no order of the columns has fewer
  std::vector<std::uint64_t> history;  // the best bound after each step
};

/// Held & Karp's ascent over the listed edges, all others at what the thresholds certify. All in integers. A
/// step is one minimum spanning tree of the lists, O(n k log n); memory 40 bytes an edge. As tight as the
/// lists are complete: see the source.
SparseBound sparse_held_karp_bound(const SparsePoints& points, const CertifiedNeighbours& neighbours,
                                   const SparseBoundOptions& options = {});

}  // namespace vismat
