// The synthetic scenes: what their header promises, and that sites are coherent.
#include "matrix/generate.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <vector>

namespace vismat {
namespace {

DeltaSceneOptions small_scene() {
  return {.shape = {2000, 1500}, .ones_per_column = 60, .sites = 30};
}

TEST(Generate, SameOptionsSameMatrixForAnyThreadCount) {
  const auto m = generate_delta_scene(small_scene(), 1);
  EXPECT_EQ(m, generate_delta_scene(small_scene(), 2));
  EXPECT_EQ(m, generate_delta_scene(small_scene(), 7));
  auto other = small_scene();
  other.seed = 2;
  EXPECT_NE(m, generate_delta_scene(other, 1));
}

TEST(Generate, HasTheShapeAndTheOnesAskedFor) {
  for (const bool harder : {false, true}) {
    for (auto scene : {power_plant_scene(1. / 128, harder), city_scene(1. / 128, harder)}) {
      const auto m = generate_delta_scene(scene);
      EXPECT_EQ(m.shape(), scene.shape);
      EXPECT_NEAR(static_cast<double>(m.ones()) / m.shape().columns, scene.ones_per_column,
                  .05 * scene.ones_per_column);
    }
  }
}

TEST(Generate, ScalesAsItSays) {
  const auto whole = power_plant_scene(1), quarter = power_plant_scene(.25);
  EXPECT_EQ(whole.shape, (Shape{350000, 400000}));
  EXPECT_EQ(quarter.shape, (Shape{87500, 100000}));
  EXPECT_EQ(quarter.sites * 4, whole.sites);
  EXPECT_DOUBLE_EQ(quarter.ones_per_column * 2, whole.ones_per_column);
  EXPECT_EQ(city_scene(1).shape, (Shape{700000, 790000}));
  EXPECT_THROW(power_plant_scene(0), std::invalid_argument);
  EXPECT_THROW(city_scene(1.1), std::invalid_argument);
}

// Nearest neighbours are far nearer than random pairs, and less so where more of the view is private.
TEST(Generate, SitesAreCoherent) {
  double share[2];
  for (const bool harder : {false, true}) {
    auto scene = small_scene();
    scene.private_view = harder ? .5 : 0;
    const auto columns = transpose(generate_delta_scene(scene));
    std::uint64_t nearest = 0, ones = 0;
    for (std::uint32_t a = 0; a < 60; ++a) {
      std::vector<char> seen(columns.shape().columns);
      for (const std::uint32_t id : columns.row(a)) seen[id] = 1;
      std::size_t least = columns.ones();
      for (std::uint32_t b = 0; b < columns.shape().rows; ++b) {
        if (a == b) continue;
        std::size_t common = 0;
        for (const std::uint32_t id : columns.row(b)) common += seen.data()[id] != 0;
        least = std::min(least, columns.row(a).size() + columns.row(b).size() - 2 * common);
      }
      nearest += least;
      ones += columns.row(a).size();
    }
    share[harder] = static_cast<double>(nearest) / static_cast<double>(ones);
  }
  EXPECT_LT(share[0], .4);
  EXPECT_GT(share[1], 1.5 * share[0]);
}

TEST(Generate, HeavierTailsAreMoreUneven) {
  const auto unevenness = [](double tail) {
    auto scene = small_scene();
    scene.range_tail = tail;
    const auto columns = transpose(generate_delta_scene(scene));
    double sum = 0, squares = 0;
    for (std::uint32_t c = 0; c < columns.shape().rows; ++c) {
      const auto ones = static_cast<double>(columns.row(c).size());
      sum += ones;
      squares += ones * ones;
    }
    return squares * columns.shape().rows / (sum * sum);
  };
  EXPECT_GT(unevenness(1), 1.2 * unevenness(10));
}

TEST(Generate, EdgesOfTheShape) {
  for (const Shape shape : {Shape{0, 0}, Shape{0, 9}, Shape{9, 0}, Shape{1, 1}, Shape{3, 200}}) {
    auto scene = small_scene();
    scene.shape = shape;
    EXPECT_EQ(generate_delta_scene(scene).shape(), shape);
  }
}

TEST(Generate, RefusesWhatMakesNoScene) {
  const auto refused = [](auto change) {
    auto scene = small_scene();
    change(scene);
    EXPECT_THROW(generate_delta_scene(scene), std::invalid_argument);
  };
  refused([](auto& s) { s.sites = 0; });
  refused([](auto& s) { s.private_view = 1.5; });
  refused([](auto& s) { s.private_view = std::numeric_limits<double>::quiet_NaN(); });
  refused([](auto& s) { s.ones_per_column = 0; });
  refused([](auto& s) { s.range_tail = .1; });
  refused([](auto& s) { s.crowd_tail = -1; });
}

}  // namespace
}  // namespace vismat
