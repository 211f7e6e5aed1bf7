// ALGORITHM. The search of local_search.h, where an exact distance costs microseconds: the edge that would close the tour is
// first tried on the sketches. They bound it from below, hence the gain from above, and what cannot gain is given up before
// anything exact is computed. Flips are refused above a limit [Johnson & McGeoch 1997 use 50000 for 10^6 points]: the tours
// come from greedy edges and have few long improvements left.
#include "layout/sparse_search.h"

#include <utility>

namespace vismat {
namespace {

class SketchedDistances {
 public:
  SketchedDistances(const SparsePoints& points, const ColumnSketches& sketches)
      : points_(points), sketches_(sketches), known_(points.size() + 1) {}
  std::int64_t distance(std::uint32_t a, std::uint32_t b) {
    return known_.of(a, b, [&] { return points_.distance(a, b); });
  }
  bool below(std::uint32_t a, std::uint32_t b, std::int64_t limit, std::int64_t& length) {
    if (limit <= 0) return false;
    const auto most = static_cast<std::uint32_t>(limit - 1);
    if (sketches_.lower_bound(a, b, most) > most) return false;
    length = distance(a, b);
    return length < limit;
  }

 private:
  const SparsePoints& points_;
  const ColumnSketches& sketches_;
  KnownDistances known_;
};

}  // namespace

std::vector<std::uint32_t> improve_tour(const SparsePoints& points, const ColumnSketches& sketches,
                                        const NeighbourLists& lists, std::vector<std::uint32_t> tour,
                                        const LocalMoves& moves) {
  if (tour.size() < 8) return tour;
  LocalSearch search(SketchedDistances(points, sketches), lists, std::move(tour), moves);
  search.push_all();
  search.run();
  return search.tour().order();
}

}  // namespace vismat
