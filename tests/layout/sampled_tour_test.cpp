// Tests the published method against the same steps done plainly.
#include "layout/tours/sampled_tour.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>

#include "layout/cost.h"
#include "matrix/generate.h"
#include "matrix/points/sparse_points.h"
#include "tests/codecs/matrices.h"

namespace vismat {
namespace {

// Where the sample is all columns and all of them are kept, step 3 is a nearest neighbour tour from column 0.
TEST(SampledTour, WithAllColumnsSampledIsTheNearestNeighbourTour) {
  for (const auto& m : test::assorted_matrices()) {
    const SparsePoints points(m.matrix, false);
    const std::uint32_t count = points.size();
    std::vector<std::uint32_t> expected;
    std::vector<bool> visited(count, false);
    for (std::uint32_t at = 0; expected.size() < count;) {
      expected.push_back(at);
      visited[at] = true;
      std::uint32_t best = 0xffffffff;
      for (std::uint32_t p = 0, least = 0xffffffff; p < count; ++p) {
        if (!visited[p] && points.distance(expected.back(), p) < least) {
          best = p;
          least = points.distance(expected.back(), p);
        }
      }
      at = best;
    }
    const auto order =
        order_by_sampled_tour(m.matrix, {.neighbours = 5000, .samples = 5000, .flip_edges = false});
    EXPECT_EQ(order.old_of_new(), expected) << m.name;
  }
}

TEST(SampledTour, ABlocksSampleIsNearlyAsGoodAsEachColumnsOwn) {
  const auto m = generate_delta_scene(power_plant_scene(1. / 256));
  const SparsePoints points(m, false);
  const std::uint32_t count = points.size(), samples = 160, k = 10;
  std::vector<std::uint32_t> visits;
  std::vector<bool> visited(count, false);
  Random random(5);
  for (std::uint32_t at = 0, free = 0; visits.size() < count;) {
    visits.push_back(at);
    visited[at] = true;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> sample;
    for (std::uint32_t s = 0; s < samples; ++s) {
      const std::uint32_t p = random.below(count);
      if (p != at) sample.emplace_back(points.distance(at, p), p);
    }
    std::sort(sample.begin(), sample.end());
    sample.resize(std::min<std::size_t>(sample.size(), k));
    const auto found =
        std::find_if(sample.begin(), sample.end(), [&](const auto& s) { return !visited[s.second]; });
    while (free < count && visited[free]) ++free;
    at = found != sample.end() ? found->second : free;
  }
  const auto order = order_by_sampled_tour(m, {.neighbours = k, .samples = samples, .flip_edges = false});
  EXPECT_NEAR(static_cast<double>(count_runs(m, order)), static_cast<double>(runs_of_visits(points, visits)),
              .1 * static_cast<double>(runs_of_visits(points, visits)));
}

TEST(SampledTour, FlipsShortenAndThreadsDoNotMatter) {
  const auto m = generate_delta_scene(power_plant_scene(1. / 256));
  const SampledTourOptions options{.neighbours = 20, .samples = 300};
  SampledTourOptions without = options, other_seed = options;
  without.flip_edges = false;
  other_seed.seed = 2;
  const auto order = order_by_sampled_tour(m, options, 1);
  EXPECT_LT(count_runs(m, order) * 10, count_runs(m, order_by_sampled_tour(m, without, 1)) * 9);
  EXPECT_EQ(order, order_by_sampled_tour(m, options, 2));
  EXPECT_NE(order, order_by_sampled_tour(m, other_seed, 2));
}

TEST(SampledTour, SampleSizeIsThePapers) {
  EXPECT_EQ(sample_size(400000, 700), 11200u);
  EXPECT_LT(sample_size(1000, 700), 7000u);
  EXPECT_EQ(sample_size(400000, 0xffffffff), 65535u);
}

TEST(SampledTour, RefusesImpossibleOptions) {
  const VisibilityMatrix m(Shape{3, 3});
  EXPECT_THROW(order_by_sampled_tour(m, {.neighbours = 0}), std::invalid_argument);
  EXPECT_THROW(order_by_sampled_tour(m, {.samples = 70000}), std::invalid_argument);
}

}  // namespace
}  // namespace vismat
