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
  for (const auto& m : test::assorted_matrices(true)) {
    const Permutation best = best_order(m.matrix);
    EXPECT_LE(count_runs(m.matrix, best), count_runs(m.matrix)) << m.name;
    EXPECT_GE(count_runs(m.matrix, best), lower_bound(m.matrix, best).runs) << m.name;
  }
}

TEST(BestOrder, KeepsAPerfectOrder) {  // of 20,100 columns, too many for all pairs: any other tour is longer
  constexpr std::uint32_t columns = 20100;
  std::vector<std::vector<std::uint32_t>> rows(columns);
  for (std::uint32_t c = 0; c < columns; ++c) {
    for (std::uint32_t r = c; r < std::min(c + 3, columns); ++r) rows[r].push_back(c);
  }
  const auto m = VisibilityMatrix::from_rows(rows, columns);
  ASSERT_EQ(count_runs(m), columns);
  EXPECT_EQ(count_runs(m, best_order(m)), columns);
}

TEST(BestOrder, BeatsTheWalkToTheNearest) {
  const auto m = generate_delta_scene(power_plant_scene(test::sanitized ? 1. / 1024 : 1. / 256));
  EXPECT_LT(count_runs(m, best_order(m)), count_runs(m, order_by_exact_tour(m)));
}

TEST(BestOrder, SameSeedSameOrder) {
  const auto m = test::clustered_matrix({150, 100}, 5);
  EXPECT_EQ(best_order(m, {.seed = 3}), best_order(m, {.seed = 3, .threads = 1}));
}

}  // namespace
}  // namespace vismat
