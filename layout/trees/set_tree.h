// A tree over rows by what they hold: for view cells of which no geometry is known, or where it says less than the sets do.
#pragma once
#include "matrix/base/parallel.h"
#include "matrix/object_tree.h"
#include "matrix/visibility_matrix.h"

namespace vismat {

/// A binary tree whose leafs are the rows (as its objects), similar ones near each other. Nodes are numbered depth first, so that what lies
/// together in the tree lies together in a file. The rows are
/// put in order as best_order does with columns; then two neighbours become one, again and again, those whose sets (a
/// row, or the union of what was joined) differ in the fewest columns. Depth is not bounded but by the rows:
/// on two levels and an artificial city the mean is 1.2 times the least and the deepest leaf at twice the least. Deterministic.
/// Takes best_order's time, and O(rows (log rows + columns / 64)); memory rows * columns / 8 bytes beside what the order takes.
/// Of no rows: an empty tree.
ObjectTree tree_by_sets(const VisibilityMatrix& matrix, const Stages& stages = {});

}  // namespace vismat
