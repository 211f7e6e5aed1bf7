// The greedy order of Zach and Karner 2003: the most similar view cell is appended, again and again.
#pragma once
#include <cstdint>

#include "matrix/base/parallel.h"
#include "matrix/permutation.h"
#include "matrix/visibility_matrix.h"

namespace vismat {

/// Each row is followed by the row, among those not yet placed, that differs from it in the fewest columns (ties: the
/// lowest row number) [Zach & Karner 2003, section 4.2]. Begins with the row that has the smallest visible set; the
/// paper does not say where to begin. At worst rows^2 * columns / 128 word operations; the index on set sizes usually
/// saves most of them. Memory: the bit matrix, rows * columns / 8 bytes. Fails towards its end, as every path to the
/// nearest does: order_by_polished_tour of the transposed matrix has fewer runs, and order_rows_by_neighbours takes
/// less time.
Permutation order_rows_greedily(const VisibilityMatrix& matrix, const Progress& progress = {});

/// The paper's variant in nearly linear time: it examines only the last row's neighbours (rows x rows, symmetric). If
/// all of them are placed, it returns to the last row that still has a free neighbour; if no row has one, to the free
/// row with the smallest visible set. Fails if similar view cells do not touch: order_rows_greedily finds them.
Permutation order_rows_by_neighbours(const VisibilityMatrix& matrix, const VisibilityMatrix& neighbours);

}  // namespace vismat
