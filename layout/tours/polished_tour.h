// Tours made of greedy edges and polished on exact lists: the fewest runs, up to some 20,000 columns.
#pragma once
#include <cstdint>
#include <vector>

#include "layout/points/column_points.h"
#include "layout/points/sparse_points.h"
#include "layout/tours/local_search.h"
#include "layout/tours/tour.h"
#include "matrix/permutation.h"
#include "matrix/visibility_matrix.h"

namespace vismat {

/// Shortest edges first, as long as they make no branch and no cycle [Bentley 1992]: the lists' edges, then all pairs of the
/// ends that these left.
Tour greedy_edge_tour(const ColumnPoints& points, const NeighbourLists& neighbours);

/// Local search, then kicks, as the source tells. Never longer than it came. Same seed and no `seconds`, same
/// tour. One thread.
Tour polish(const ColumnPoints& points, const NeighbourLists& neighbours, Tour tour,
            const PolishOptions& options = {});

struct PolishedTourOptions {
  std::uint32_t neighbours = 10;  // a point; 8 to 12 polish alike
  PolishOptions polish = {.kicks_per_point = 20};
};

/// exact_neighbours, greedy_edge_tour, polish: the points, from the zero point on.
std::vector<std::uint32_t> polished_visits(const SparsePoints& points,
                                           const PolishedTourOptions& options = {}, unsigned threads = 0);

/// All of it for a matrix, equal columns collapsed. Same seed and no `seconds`, same order, for any thread count. Memory: the
/// columns as bits, and 700 bytes a column. Breaks beyond some 20,000 distinct columns, whose pairs are too many: use
/// order_by_scale_tour there.
Permutation order_by_polished_tour(const VisibilityMatrix& matrix, const PolishedTourOptions& options = {},
                                   unsigned threads = 0);

}  // namespace vismat
