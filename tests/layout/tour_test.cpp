// Tests how tours are cut into orders.
#include "layout/tours/tour.h"

#include <gtest/gtest.h>

#include "layout/cost.h"
#include "layout/tours/exact_tour.h"
#include "tests/codecs/matrices.h"

namespace vismat {
namespace {

TEST(Tour, IsTwiceAsLongAsItsOrderHasRuns) {
  for (const auto& m : test::assorted_matrices()) {
    const ColumnPoints points(m.matrix);
    const Tour tour = nearest_neighbour_tour(points);
    EXPECT_EQ(tour_length(points, tour), 2 * count_runs(m.matrix, order_of_tour(tour))) << m.name;
    EXPECT_EQ(order_of_tour(tour_of_order(order_of_tour(tour))), order_of_tour(tour)) << m.name;
  }
}

TEST(Tour, IsCutOpenAtTheZeroPoint) {
  EXPECT_EQ(visits_of_tour({2, 0, 3, 1}), (std::vector<std::uint32_t>{1, 2, 0}));
  EXPECT_EQ(visits_of_tour({0}), (std::vector<std::uint32_t>{}));
}

}  // namespace
}  // namespace vismat
