// An order of columns for matrices of any size: near points found with sketches, joined by greedy edges, and polished.
#pragma once
#include <cstdint>
#include <vector>

#include "matrix/permutation.h"
#include "matrix/points/sketch.h"
#include "matrix/points/sparse_points.h"
#include "matrix/visibility_matrix.h"

namespace vismat {

struct ScaleOptions {
  NearbyOptions nearby;
  std::uint32_t sketch_bits = 0;  // 0: by the columns' numbers of ones, see ColumnSketches
  /// If above 0, kicks the tour for that long, and the order depends on the machine's speed.
  double seconds = 0;
};

/// The shortest listed edges first, as long as they make no branch and no cycle. The fragments' ends are then joined by
/// min-hash among themselves, round after round. Returns a closed tour of all points, the zero point among them.
std::vector<std::uint32_t> greedy_tour(const SparsePoints& points, const ColumnSketches& sketches,
                                       const NeighbourLists& lists, std::uint64_t seed = 1,
                                       unsigned threads = 0);

/// nearby_points, greedy_tour, improve_tour and kick_tour: returns the points from the zero point on.
std::vector<std::uint32_t> visits_at_scale(const SparsePoints& points, const ScaleOptions& options = {},
                                           unsigned threads = 0);

/// The whole order of a matrix, with equal columns collapsed. Without `seconds` the same seed gives the same order with
/// any number of threads. Nearly linear in the ones; memory: the matrix once more, bits / 8 and about 200 bytes for
/// each column. If no column has near ones (as with random columns) it is no better than any other order. Below some
/// thousands of dense columns order_by_polished_tour has exact lists and fewer runs.
Permutation order_by_scale_tour(const VisibilityMatrix& matrix, const ScaleOptions& options = {},
                                unsigned threads = 0);

}  // namespace vismat
