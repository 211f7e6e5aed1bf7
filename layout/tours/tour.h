// Closed tours through points and the zero point, and the orders that result from cutting them there.
#pragma once
#include <cstdint>
#include <vector>

#include "matrix/permutation.h"
#include "matrix/points/column_points.h"

namespace vismat {

/// Each point of [0, size] once, the zero point (number size) among them.
using Tour = std::vector<std::uint32_t>;

std::uint64_t tour_length(const ColumnPoints& points, const Tour& tour);
/// The points from the zero point around to it again, without it.
std::vector<std::uint32_t> visits_of_tour(Tour tour);
/// The same as an order of columns; each column is a point.
Permutation order_of_tour(const Tour& tour);
Tour tour_of_order(const Permutation& order);

}  // namespace vismat
