// Tours that are made of greedy edges and polished on exact neighbour lists: the fewest runs, up to some 20,000
// columns.
#pragma once
#include <cstdint>
#include <vector>

#include "layout/tours/local_search.h"
#include "layout/tours/tour.h"
#include "matrix/permutation.h"
#include "matrix/points/column_points.h"
#include "matrix/points/sparse_points.h"
#include "matrix/visibility_matrix.h"

namespace vismat {

/// Takes the shortest edges first, as long as they make no branch and no cycle [Bentley 1992]: first the lists' edges,
/// then all pairs of the ends that these left.
Tour greedy_edge_tour(const ColumnPoints& points, const NeighbourLists& neighbours);

/// Local search, then kicks, as local_search.h says. The tour never gets longer. Without `seconds` the same seed gives
/// the same tour. One thread.
Tour polish(const ColumnPoints& points, const NeighbourLists& neighbours, Tour tour,
            const PolishOptions& options = {});

struct PolishedTourOptions {
  std::uint32_t neighbours = 10;  // of each point
  PolishOptions polish = {.kicks_per_point = 20};
};

/// exact_neighbours, greedy_edge_tour and polish: returns the points from the zero point on.
std::vector<std::uint32_t> polished_visits(const SparsePoints& points,
                                           const PolishedTourOptions& options = {}, unsigned threads = 0);

/// The whole order of a matrix, with equal columns collapsed. Without `seconds` the same seed gives the same order with
/// any number of threads. Memory: the columns as bits, and 700 bytes for each column. Fails beyond some 20,000 distinct
/// columns, which have too many pairs: use order_by_scale_tour there.
Permutation order_by_polished_tour(const VisibilityMatrix& matrix, const PolishedTourOptions& options = {},
                                   unsigned threads = 0);

}  // namespace vismat
