// A tree over rows by their sets: for view cells whose geometry is not known, or says less than the sets do.
#pragma once
#include "matrix/base/parallel.h"
#include "matrix/object_tree.h"
#include "matrix/visibility_matrix.h"

namespace vismat {

/// A binary tree whose leaves hold the rows (as its objects), similar ones near each other. Nodes are numbered depth
/// first, so that what is together in the tree is together in a file. The rows are ordered as best_order orders
/// columns. Then two neighbours become one, again and again: those whose sets (a row, or the union of what was joined)
/// differ in the fewest columns. Only the number of rows limits the depth. Deterministic. Takes best_order's time, and
/// O(rows (log rows + columns / 64)); memory: rows * columns / 8 bytes besides what the order takes. The tree of no
/// rows is empty.
ObjectTree tree_by_sets(const VisibilityMatrix& matrix, const Stages& stages = {});

}  // namespace vismat
