// ALGORITHM. Polished tours. local_search.h has the method; here distances are counted bits, and those of tour edges
// are kept.
//
// Measured with 20 kicks for each point, above Held and Karp's bound: artificial 1 0.21 %, in 0.5 s of processor time;
// view cells of ctf_compromise (3364 columns) 0.98 % in 1.7 s, faces of oasago2 1.55 % in 0.7 s, six more matrices of
// view cells and faces 0.8 to 1.8 %; artificial 2 (5461 columns of 24578 rows) 3140248 runs in 6.8 s with the lists,
// two cores shared with others. 50 kicks for each point save 0 to 0.2 % more.
#include "layout/tours/polished_tour.h"

#include <utility>

#include "layout/tours/fragments.h"
#include "layout/tours/local_search.h"
#include "matrix/points/distinct_columns.h"

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
  if (tour.size() < 8) return tour;
  LocalSearch search(BitDistances(points), neighbours, std::move(tour));
  search.push_all();
  search.run();
  iterate(search, options);
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
