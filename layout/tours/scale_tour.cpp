// ALGORITHM. Tours of very many points. Greedy edges [Bentley 1992] over the lists leave fragments: the points near
// their ends are inside other fragments. So only the ends are sorted by min-hash, with another seed in each round.
// Neighbours within a window become candidate edges, shortest sketch distance first, and the number of ends falls by
// some factor in each round (an end's window always holds one of another fragment). The last few thousand ends are
// matched by all pairs of sketches.
//
// Measured (bench order-scale): power plant, 400,000 columns, 5.2e8 ones: 0.1236 of a random permutation's runs, 102 s
// of processor time (136 s on two cores that others used as well), 5.3 GB; the two-nearest bound is 1.23 times below
// it. With one kick for each point 0.1231 in 191 s.
#include "layout/tours/scale_tour.h"

#include <algorithm>

#include "layout/tours/fragments.h"
#include "layout/tours/sparse_search.h"
#include "layout/tours/tour.h"

namespace vismat {
namespace {

// Edges between each of `order` and those up to `window` places further on that belong to other fragments.
void add_window_edges(const std::vector<std::uint32_t>& order, std::size_t window,
                      const ColumnSketches& sketches, Fragments& fragments, std::vector<Edge>& edges) {
  for (std::size_t i = 0; i < order.size(); ++i) {
    for (std::size_t j = i + 1; j < std::min(order.size(), i + 1 + window); ++j) {
      const auto [a, b] = std::minmax(order[i], order[j]);
      if (!fragments.same(a, b)) edges.push_back({sketches.lower_bound(a, b), a, b});
    }
  }
}

}  // namespace

std::vector<std::uint32_t> greedy_tour(const SparsePoints& points, const ColumnSketches& sketches,
                                       const NeighbourLists& lists, std::uint64_t seed, unsigned threads) {
  Fragments fragments(points.size() + 1);
  std::vector<Edge> edges = edges_of(lists);
  fragments.join_shortest_first(edges);
  constexpr std::size_t few = 3000, window = 10;
  auto ends = fragments.ends();
  for (std::uint64_t round = 1; ends.size() > few; ++round) {
    edges.clear();
    for (const auto& order : min_hash_orders(points, ends, 8, seed + round, threads))
      add_window_edges(order, window, sketches, fragments, edges);
    fragments.join_shortest_first(edges);
    ends = fragments.ends();
  }
  return fragments.join_all([&](std::uint32_t a, std::uint32_t b) { return sketches.lower_bound(a, b); });
}

std::vector<std::uint32_t> visits_at_scale(const SparsePoints& points, const ScaleOptions& options,
                                           unsigned threads) {
  const std::uint64_t seed = options.nearby.seed;
  const ColumnSketches sketches(points, options.sketch_bits, threads);
  const NeighbourLists lists = nearby_points(points, sketches, options.nearby, threads);
  std::vector<std::uint32_t> tour =
      improve_tour(points, sketches, lists, greedy_tour(points, sketches, lists, seed, threads));
  const PolishOptions kicks{.kicks_per_point = .25,
                            .seed = seed,
                            .seconds = options.seconds,
                            .progress = begin_stage(options.nearby.stages, "kicks of the tour")};
  return visits_of_tour(kick_tour(points, sketches, lists, std::move(tour), kicks, threads));
}

Permutation order_by_scale_tour(const VisibilityMatrix& matrix, const ScaleOptions& options,
                                unsigned threads) {
  const SparsePoints points(matrix);
  return points.order_of_columns(visits_at_scale(points, options, threads));
}

}  // namespace vismat
