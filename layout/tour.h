// Tours through the columns' points and the zero point: made, polished, cut open into orders.
#pragma once
#include <cstdint>
#include <functional>
#include <vector>

#include "layout/column_points.h"
#include "matrix/permutation.h"

namespace vismat {

/// A closed tour: each point of [0, size] once, the zero point (number size) among them.
using Tour = std::vector<std::uint32_t>;

std::uint64_t tour_length(const ColumnPoints& points, const Tour& tour);
/// The order of columns from the zero point around to it again.
Permutation order_of_tour(const Tour& tour);
Tour tour_of_order(const Permutation& order);

/// Shortest edges first, as long as they make no branch and no cycle; then the fragments' ends, nearest
/// first, until one path is left [Bentley 1992]. Candidates are the lists' edges; fragments that they do not
/// join are matched by all pairs of their ends.
Tour greedy_edge_tour(const ColumnPoints& points, const NeighbourLists& neighbours);

/// The nearest point not yet visited, from the zero point on. O(columns^2) distances.
Tour nearest_neighbour_tour(const ColumnPoints& points);

struct PolishOptions {
  /// Kicks of iterated local search a point, after the first local optimum; 0: none.
  double kicks_per_point = 50;
  std::uint64_t seed = 1;
  /// If above 0, stops kicking after that long: the tour then depends on the machine's speed.
  double seconds = 0;
};

/// Local search, then kicks, as the source tells. Never longer than it came. Same seed and no `seconds`, same
/// tour.
Tour polish(const ColumnPoints& points, const NeighbourLists& neighbours, Tour tour,
            const PolishOptions& options = {});

}  // namespace vismat
