// The tour that always goes to the true nearest neighbour.
#pragma once
#include "layout/tours/tour.h"
#include "matrix/permutation.h"
#include "matrix/points/column_points.h"
#include "matrix/visibility_matrix.h"

namespace vismat {

/// Begins at the zero point and always goes to the nearest point not yet visited; ties: the lowest number. Looks at all
/// pairs: O(columns^2 * rows / 64) word operations, one thread.
Tour nearest_neighbour_tour(const ColumnPoints& points);

/// The order of that tour; the sampled tour is compared with it. Deterministic; memory: the columns as bits. Fails
/// towards its end, when the columns that it passed by are far apart: order_by_polished_tour has fewer runs
/// (docs/orders.md). Beyond 20,000 columns use order_by_scale_tour.
Permutation order_by_exact_tour(const VisibilityMatrix& matrix);

}  // namespace vismat
