#include "layout/tours/tour.h"

#include <algorithm>
#include <utility>

namespace vismat {

std::uint64_t tour_length(const ColumnPoints& points, const Tour& tour) {
  std::uint64_t length = 0;
  for (std::size_t i = 0; i < tour.size(); ++i)
    length += points.distance(tour[i], tour[(i + 1) % tour.size()]);
  return length;
}

std::vector<std::uint32_t> visits_of_tour(Tour tour) {
  std::rotate(tour.begin(), std::max_element(tour.begin(), tour.end()), tour.end());
  tour.erase(tour.begin());
  return tour;
}

Permutation order_of_tour(const Tour& tour) {
  return Permutation::from_old_of_new(visits_of_tour(tour));
}

Tour tour_of_order(const Permutation& order) {
  Tour tour = order.old_of_new();
  tour.push_back(order.size());
  return tour;
}

}  // namespace vismat
