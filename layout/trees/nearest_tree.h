// Neighbours for view cells whose geometry is not known: a spanning tree of similar rows.
#pragma once
#include "matrix/base/parallel.h"
#include "matrix/visibility_matrix.h"

namespace vismat {

/// A spanning tree of the rows by Hamming distance, of the least total length: rows x rows, symmetric. The differences
/// between its neighbours have the fewest ones of any tree. Exact; of equally near rows the first is taken, so every
/// run gives the same tree. Takes the distances between all distinct rows: of sparse rows, one addition for each two ones
/// in the same column, which grow with the square of the sides of a scene; of dense ones, rows^2 * columns / 64 word
/// operations at most (docs/growth.md has times). Memory: rows * columns / 8 bytes, or 12 for each one of sparse rows.
VisibilityMatrix nearest_tree(const VisibilityMatrix& matrix, const Progress& progress = {});

}  // namespace vismat
