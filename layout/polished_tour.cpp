#include "layout/polished_tour.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "layout/distinct_columns.h"
#include "layout/fragments.h"
#include "layout/local_search.h"
#include "matrix/random.h"

namespace vismat {
namespace {

class BitDistances {
 public:
  explicit BitDistances(const ColumnPoints& points) : points_(points), known_(points.size() + 1) {}
  std::int64_t distance(std::uint32_t a, std::uint32_t b) {
    return known_.of(a, b, [&] { return points_.distance(a, b); });
  }
  bool below(std::uint32_t a, std::uint32_t b, std::int64_t limit, std::int64_t& length) {
    if (limit <= 0) return false;
    length = distance(a, b);
    return length < limit;
  }

 private:
  const ColumnPoints& points_;
  KnownDistances known_;
};

}  // namespace

Tour greedy_edge_tour(const ColumnPoints& points, const NeighbourLists& neighbours) {
  Fragments fragments(points.size() + 1);
  std::vector<Edge> edges = edges_of(neighbours);
  fragments.join_shortest_first(edges);
  return fragments.join_all([&](std::uint32_t a, std::uint32_t b) { return points.distance(a, b); });
}

Tour polish(const ColumnPoints& points, const NeighbourLists& neighbours, Tour tour,
            const PolishOptions& options) {
  const auto count = static_cast<std::uint32_t>(tour.size());
  if (count < 8) return tour;
  LocalSearch search(BitDistances(points), neighbours, std::move(tour));
  search.push_all();
  search.run();
  Random random(options.seed);
  const auto start = std::chrono::steady_clock::now();
  const auto kicks = static_cast<std::uint64_t>(options.kicks_per_point * count);
  const std::uint32_t longest = std::min(50u, (count - 2) / 3);
  std::uint32_t place = 0;
  for (std::uint64_t kick = 0; kick < kicks; ++kick) {
    if (options.seconds > 0 && kick % 256 == 0 &&
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() > options.seconds) {
      break;
    }
    search.mark();
    place = (place + random.below(20)) % count;  // so that what the last kick looked at is at hand
    const std::uint32_t one = 1 + random.below(longest), two = 1 + random.below(longest);
    const std::int64_t saved = search.kick(place, one, two);
    if (saved + search.run() < 0) search.undo();
  }
  return search.tour().order();
}

std::vector<std::uint32_t> polished_visits(const SparsePoints& points, const PolishedTourOptions& options,
                                           unsigned threads) {
  const ColumnPoints columns(matrix_of(points));
  const NeighbourLists lists = exact_neighbours(columns, options.neighbours, threads);
  return visits_of_tour(polish(columns, lists, greedy_edge_tour(columns, lists), options.polish));
}

Permutation order_by_polished_tour(const VisibilityMatrix& matrix, const PolishedTourOptions& options,
                                   unsigned threads) {
  const SparsePoints points(matrix);
  return points.order_of_columns(polished_visits(points, options, threads));
}

}  // namespace vismat
