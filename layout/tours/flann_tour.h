// A column order whose near columns are found by FLANN.
#pragma once
#include <cstdint>

#include "layout/points/column_points.h"
#include "layout/tours/polished_tour.h"
#include "matrix/permutation.h"
#include "matrix/visibility_matrix.h"

namespace vismat {

struct FlannOptions {
  std::uint32_t neighbours = 10;  // a point
  std::uint32_t trees = 4;        // each splits the points anew
  std::uint32_t branching = 32;   // parts a node is split into, at least 2
  std::uint32_t leaf_points = 100;
  std::uint32_t checks = 512;  // points a query looks at, 1 to 2^31 - 1
};

/// The nearest other points of each as FLANN's hierarchical clustering finds them [Muja & Lowe 2012], with exact
/// distances: a list is always full, nearest first, but may miss some that are nearer. `points` are the columns of
/// `matrix`, which should be distinct. Up to leaf_points, the exact lists.
/// Throws std::invalid_argument for options out of range.
NeighbourLists flann_neighbours(const VisibilityMatrix& matrix, const ColumnPoints& points,
                                const FlannOptions& options = {}, unsigned threads = 0);

/// Equal columns collapsed, FLANN's lists, greedy edges, polish. NOT REPRODUCIBLE: FLANN takes its seeds from the system,
/// so each call may give another order. Memory: the columns as bits, twice. Building the index is single-threaded; each
/// query takes memory for all points. Its tours are those of order_by_polished_tour, which it is there to be compared with,
/// and mostly dearer. Breaks beyond some 20,000 columns as that does: use order_by_scale_tour there.
///
/// FLANN is private to the source, and headers only: who links vismat::layout needs liblz4 beside it, no more, so that the
/// table of orders can list it without a library of its own.
Permutation order_by_flann_tour(const VisibilityMatrix& matrix, const FlannOptions& options = {},
                                const PolishOptions& polishing = {.kicks_per_point = 20},
                                unsigned threads = 0);

}  // namespace vismat
