// Tests moves against the tours to which they lead.
#include "layout/tours/local_search.h"

#include <gtest/gtest.h>

#include <numeric>

#include "layout/tours/tour.h"
#include "matrix/base/random.h"
#include "tests/codecs/matrices.h"

namespace vismat {
namespace {

struct Bits {
  const ColumnPoints* points;
  std::int64_t distance(std::uint32_t a, std::uint32_t b) const { return points->distance(a, b); }
  bool below(std::uint32_t a, std::uint32_t b, std::int64_t limit, std::int64_t& length) const {
    length = distance(a, b);
    return length < limit;
  }
};

Tour counted(std::uint32_t size) {
  Tour tour(size);
  std::iota(tour.begin(), tour.end(), 0u);
  return tour;
}

TEST(LocalSearch, SavesWhatItSays) {
  for (const std::uint32_t columns : {7u, 9u, 20u, 150u}) {
    for (const bool three_opt : {false, true}) {
      for (std::uint64_t seed = 0; seed < 20; ++seed) {
        const auto m = test::random_matrix({40, columns}, .3, seed);
        const ColumnPoints points(m);
        const auto lists = exact_neighbours(points, 6);
        const Tour start = counted(columns + 1);
        LocalSearch search(Bits{&points}, lists, start, {.three_opt = three_opt});
        search.push_all();
        const std::int64_t saved = search.run();
        EXPECT_GE(saved, 0);
        EXPECT_EQ(tour_length(points, search.tour().order()) + static_cast<std::uint64_t>(saved),
                  tour_length(points, start));
      }
    }
  }
}

TEST(LocalSearch, LeavesNoTwoOptMoveOverItsLists) {
  const auto m = test::clustered_matrix({100, 80}, 3);
  const ColumnPoints points(m);
  const auto lists = exact_neighbours(points, 6);
  LocalSearch search(Bits{&points}, lists, counted(81));
  search.push_all();
  search.run();
  const ArrayTour& tour = search.tour();
  for (std::uint32_t p = 0; p < tour.size(); ++p) {
    for (std::uint32_t i = 0; i < lists.per_point; ++i) {
      const std::uint32_t c = lists.ids[p * lists.per_point + i];
      EXPECT_LE(points.distance(p, tour.next(p)) + points.distance(c, tour.next(c)),
                points.distance(p, c) + points.distance(tour.next(p), tour.next(c)));
      EXPECT_LE(points.distance(p, tour.prev(p)) + points.distance(c, tour.prev(c)),
                points.distance(p, c) + points.distance(tour.prev(p), tour.prev(c)));
    }
  }
}

TEST(LocalSearch, TakesAKickBack) {
  const auto m = test::clustered_matrix({100, 80}, 3);
  const ColumnPoints points(m);
  const auto lists = exact_neighbours(points, 6);
  LocalSearch search(Bits{&points}, lists, counted(81));
  Random random(5);
  for (int trial = 0; trial < 300; ++trial) {
    const Tour before = search.tour().order();
    const std::uint64_t length = tour_length(points, before);
    search.mark();
    const std::int64_t saved = search.kick(random.below(81), 1 + random.below(26), 1 + random.below(26));
    EXPECT_EQ(static_cast<std::int64_t>(length) - saved,
              static_cast<std::int64_t>(tour_length(points, search.tour().order())));
    EXPECT_NE(search.tour().order(), before);
    search.run();
    search.undo();
    EXPECT_EQ(search.tour().order(), before);
  }
}

TEST(KnownDistances, AreNeverAnotherPairs) {
  KnownDistances known(300);
  Random random(6);
  for (int trial = 0; trial < 100000; ++trial) {
    const std::uint32_t a = random.below(300), b = random.below(300);
    const auto apart = [&] { return a < b ? a * 1000 + b : b * 1000 + a; };
    ASSERT_EQ(known.of(a, b, apart), apart());
  }
}

}  // namespace
}  // namespace vismat
