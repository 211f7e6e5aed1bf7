// An order of columns by a polished tour on neighbours that FLANN finds.
#pragma once
#include <cstdint>

#include "layout/tours/polished_tour.h"
#include "matrix/permutation.h"
#include "matrix/points/column_points.h"
#include "matrix/visibility_matrix.h"

namespace vismat {

struct FlannOptions {
  std::uint32_t neighbours = 10;  // of each point
  std::uint32_t trees = 4;        // each with a split of its own
  std::uint32_t branching = 32;   // parts a node is split into, at least 2
  std::uint32_t leaf_points = 100;
  std::uint32_t checks = 512;  // points a query looks at, 1 to 2^31 - 1
};

/// The nearest other points of each point as FLANN's hierarchical clustering finds them [Muja & Lowe 2012], with exact
/// distances. A list is always full, nearest first, but may miss some points that are nearer. `points` are the columns
/// of `matrix`, which should be distinct. Up to leaf_points points the lists are exact. Throws std::invalid_argument
/// for options out of range.
NeighbourLists flann_neighbours(const VisibilityMatrix& matrix, const ColumnPoints& points,
                                const FlannOptions& options = {}, unsigned threads = 0);

/// Equal columns are collapsed; then come FLANN's lists, greedy edges and polishing. NOT REPRODUCIBLE: FLANN takes its
/// seeds from the system, so each call may give another order. Memory: the columns as bits, twice. The index is built
/// on one thread; each query takes memory for all points. The tours are as good as those of order_by_polished_tour,
/// with which they are to be compared, and mostly take longer. Fails beyond some 20,000 columns like that one: use
/// order_by_scale_tour there.
///
/// FLANN is private to the source and consists of headers only. So vismat::layout needs only liblz4 besides, and the
/// table of orders can list this order without a library of its own.
Permutation order_by_flann_tour(const VisibilityMatrix& matrix, const FlannOptions& options = {},
                                const PolishOptions& polishing = {.kicks_per_point = 20},
                                unsigned threads = 0);

}  // namespace vismat
