// The walk to the true nearest neighbour.
#pragma once
#include "layout/points/column_points.h"
#include "layout/tours/tour.h"
#include "matrix/permutation.h"
#include "matrix/visibility_matrix.h"

namespace vismat {

/// From the zero point on, always to the nearest point not yet visited; ties: the lowest number. All pairs:
/// O(columns^2 * rows / 64) word operations, one thread.
Tour nearest_neighbour_tour(const ColumnPoints& points);

/// That, of a matrix: what the sampled tour is measured against. Deterministic; memory: the columns as bits. Breaks towards
/// its end, where what it passed by has to be fetched from afar: 7 to 16 % more runs than order_by_polished_tour on levels
/// and cities; beyond 20,000 columns use order_by_scale_tour.
Permutation order_by_exact_tour(const VisibilityMatrix& matrix);

}  // namespace vismat
