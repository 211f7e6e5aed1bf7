#include "layout/tours/exact_tour.h"

#include <cstdint>
#include <numeric>
#include <vector>

namespace vismat {

Tour nearest_neighbour_tour(const ColumnPoints& points) {
  std::vector<std::uint32_t> left(points.size());
  std::iota(left.begin(), left.end(), 0u);
  Tour tour = {points.zero()};
  while (!left.empty()) {
    std::uint32_t best = 0xffffffff;
    std::size_t best_at = 0;
    for (std::size_t i = 0; i < left.size(); ++i) {
      const std::uint32_t d = points.distance(tour.back(), left[i], best);
      if (d < best || (d == best && left[i] < left[best_at])) best = d, best_at = i;
    }
    tour.push_back(left[best_at]);
    left[best_at] = left.back();
    left.pop_back();
  }
  return tour;
}

Permutation order_by_exact_tour(const VisibilityMatrix& matrix) {
  return order_of_tour(nearest_neighbour_tour(ColumnPoints(matrix)));
}

}  // namespace vismat
