// Paper 002's order of view cells: always the most similar cell next.
#pragma once
#include <cstdint>

#include "matrix/base/parallel.h"
#include "matrix/permutation.h"
#include "matrix/visibility_matrix.h"

namespace vismat {

/// Each row is followed by the one, among those not yet placed, that differs from it in the fewest columns
/// (ties: the lowest row number) [Zach & Karner 2003, 4.2]. Begins with the row of the smallest visible set,
/// which the paper leaves open. At worst rows^2 * columns / 128 word operations; the index on set sizes
/// usually saves most of them. Memory: the bit matrix, rows * columns / 8 bytes. Breaks towards its end, as every walk to
/// the nearest does: order_by_polished_tour of the transposed matrix has fewer runs, order_rows_by_neighbours less to do.
Permutation order_rows_greedily(const VisibilityMatrix& matrix, const Progress& progress = {});

/// The paper's variant in nearly linear time: only the last row's neighbours are asked (rows x rows,
/// symmetric). Where all of them are placed, the walk goes back to the last row that still has a free
/// neighbour; where none has, to the free row of the smallest visible set. Breaks where similar
/// cells do not touch: order_rows_greedily looks further.
Permutation order_rows_by_neighbours(const VisibilityMatrix& matrix, const VisibilityMatrix& neighbours);

}  // namespace vismat
