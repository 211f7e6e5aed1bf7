// The order of columns to take at any size: near points found by sketches, joined by greedy edges, polished.
#pragma once
#include <cstdint>
#include <vector>

#include "layout/points/sketch.h"
#include "layout/points/sparse_points.h"
#include "matrix/permutation.h"
#include "matrix/visibility_matrix.h"

namespace vismat {

struct ScaleOptions {
  NearbyOptions nearby;
  std::uint32_t sketch_bits = 0;  // 0: by the columns' weight, see ColumnSketches
  /// If above 0, kicks the tour for that long; the order then depends on the machine's speed.
  double seconds = 0;
};

/// Shortest listed edges first, as long as they make no branch and no cycle; the fragments' ends are joined
/// by min-hash among themselves, round after round. A closed tour of all points, the zero point among them.
std::vector<std::uint32_t> greedy_tour(const SparsePoints& points, const ColumnSketches& sketches,
                                       const NeighbourLists& lists, std::uint64_t seed = 1,
                                       unsigned threads = 0);

/// nearby_points, greedy_tour, improve_tour, kick_tour: the points, from the zero point on.
std::vector<std::uint32_t> visits_at_scale(const SparsePoints& points, const ScaleOptions& options = {},
                                           unsigned threads = 0);

/// All of it for a matrix, equal columns collapsed. Same seed and no `seconds`, same order, for any thread count. Nearly
/// linear in the ones; memory: the matrix once more, bits / 8 and about 200 bytes a column. Where lists
/// cannot be had (random columns, which have no near ones) it is no better than any other; below some
/// thousands of dense columns order_by_polished_tour has exact lists and fewer runs.
Permutation order_by_scale_tour(const VisibilityMatrix& matrix, const ScaleOptions& options = {},
                                unsigned threads = 0);

}  // namespace vismat
