// Tests the default order.
#include "layout/best_order.h"

#include <gtest/gtest.h>

#include "layout/bounds/bound.h"
#include "layout/cost.h"
#include "layout/orders/random_order.h"
#include "layout/tours/exact_tour.h"
#include "matrix/generate.h"
#include "tests/codecs/matrices.h"
#include "tests/sanitized.h"

namespace vismat {
namespace {

TEST(BestOrder, IsNeverWorseThanTheColumnsAsTheyStand) {
  for (const auto& m : test::assorted_matrices()) {
    const Permutation best = best_order(m.matrix);
    EXPECT_LE(count_runs(m.matrix, best), count_runs(m.matrix)) << m.name;
    EXPECT_GE(count_runs(m.matrix, best), lower_bound(m.matrix, best).runs) << m.name;
  }
}

TEST(BestOrder, KeepsAPerfectOrder) {  // of 25,000 columns, too many for all pairs: any other tour is longer
  std::vector<std::vector<std::uint32_t>> rows(25000);
  for (std::uint32_t c = 0; c < 25000; ++c) {
    for (std::uint32_t r = c; r < std::min(c + 3, 25000u); ++r) rows[r].push_back(c);
  }
  const auto m = VisibilityMatrix::from_rows(rows, 25000);
  ASSERT_EQ(count_runs(m), 25000u);
  EXPECT_EQ(count_runs(m, best_order(m)), 25000u);
}

TEST(BestOrder, BeatsTheWalkToTheNearest) {
  const auto m = generate_delta_scene(power_plant_scene(test::sanitized ? 1. / 1024 : 1. / 256));
  EXPECT_LT(count_runs(m, best_order(m)), count_runs(m, order_by_exact_tour(m)));
}

TEST(BestOrder, SameSeedSameOrder) {
  const auto m = test::clustered_matrix({200, 150}, 5);
  EXPECT_EQ(best_order(m, {.seed = 3}), best_order(m, {.seed = 3, .threads = 1}));
}

}  // namespace
}  // namespace vismat
