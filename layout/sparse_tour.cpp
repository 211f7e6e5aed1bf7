// ALGORITHM. Greedy edges [Bentley 1992] over the lists leave fragments: what is near their ends lies inside
// other fragments. So the ends alone are sorted by min-hash, with another seed each round; neighbours within
// a window become candidate edges, shortest sketch distance first, and the number of ends falls by some
// factor a round (an end's window always holds one of another fragment). The last few thousand ends are
// matched by all pairs of sketches.
//
// Measured (bench/order_scale): power plant, 400,000 columns, 5.2e8 ones: .130 of a random permutation's runs,
// .343 of the complete printed method's, 117 s on two cores that others used as well, 4.9 GB. The 2-nearest
// bound is 1.345 times below it, Held-Karp after 60 steps 1.278.
#include "layout/sparse_tour.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <utility>

#include "layout/sparse_search.h"
#include "matrix/parallel.h"

namespace vismat {
namespace {

constexpr std::uint32_t none = 0xffffffff;

struct Edge {
  std::uint32_t distance, a, b;
  auto operator<=>(const Edge&) const = default;
};

class Fragments {
 public:
  explicit Fragments(std::uint32_t size) : root_(size), links_(size, {none, none}) {
    std::iota(root_.begin(), root_.end(), 0u);
  }
  void join_shortest_first(std::vector<Edge>& edges) {
    std::sort(edges.begin(), edges.end());
    for (const Edge& e : edges) {
      if (!is_end(e.a) || !is_end(e.b) || find(e.a) == find(e.b)) continue;
      root_[find(e.a)] = find(e.b);
      link(e.a, e.b);
      link(e.b, e.a);
    }
  }
  std::vector<std::uint32_t> ends() const {
    std::vector<std::uint32_t> ends;
    for (std::uint32_t p = 0; p < root_.size(); ++p) {
      if (is_end(p)) ends.push_back(p);
    }
    return ends;
  }
  std::uint32_t find(std::uint32_t p) {
    while (root_[p] != p) p = root_[p] = root_[root_[p]];
    return p;
  }
  // Along the one path that is left.
  std::vector<std::uint32_t> walk(std::uint32_t start) const {
    std::vector<std::uint32_t> tour;
    for (std::uint32_t at = start, from = none; at != none;) {
      tour.push_back(at);
      const std::uint32_t to = links_[at][0] != from ? links_[at][0] : links_[at][1];
      from = at;
      at = to;
    }
    return tour;
  }

 private:
  bool is_end(std::uint32_t p) const { return links_[p][1] == none; }
  void link(std::uint32_t from, std::uint32_t to) { links_[from][links_[from][0] != none] = to; }
  std::vector<std::uint32_t> root_;
  std::vector<std::array<std::uint32_t, 2>> links_;
};

// Edges between each of `order` and those up to `window` places further on that belong to other fragments.
void add_window_edges(const std::vector<std::uint32_t>& order, std::size_t window,
                      const ColumnSketches& sketches, Fragments& fragments, std::vector<Edge>& edges) {
  for (std::size_t i = 0; i < order.size(); ++i) {
    for (std::size_t j = i + 1; j < std::min(order.size(), i + 1 + window); ++j) {
      const auto [a, b] = std::minmax(order[i], order[j]);
      if (fragments.find(a) != fragments.find(b)) edges.push_back({sketches.lower_bound(a, b), a, b});
    }
  }
}

}  // namespace

std::vector<std::uint32_t> greedy_tour(const SparsePoints& points, const ColumnSketches& sketches,
                                       const NeighbourLists& lists, std::uint64_t seed, unsigned threads) {
  Fragments fragments(points.size() + 1);
  std::vector<Edge> edges;
  for (std::uint32_t p = 0; p < points.size(); ++p) {
    for (std::size_t i = std::size_t{p} * lists.per_point; i < std::size_t{p + 1} * lists.per_point; ++i) {
      if (lists.ids[i] != none)
        edges.push_back({lists.distances[i], std::min(p, lists.ids[i]), std::max(p, lists.ids[i])});
    }
  }
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
  edges.clear();
  add_window_edges(ends, ends.size(), sketches, fragments, edges);
  fragments.join_shortest_first(edges);
  return fragments.walk(fragments.ends().front());
}

std::vector<std::uint32_t> visits_at_scale(const SparsePoints& points, const ColumnSketches& sketches,
                                           const NeighbourLists& lists, std::uint64_t seed,
                                           unsigned threads) {
  auto tour = improve_tour(points, sketches, lists, greedy_tour(points, sketches, lists, seed, threads));
  std::rotate(tour.begin(), std::find(tour.begin(), tour.end(), points.zero()), tour.end());
  tour.erase(tour.begin());
  return tour;
}

Permutation order_at_scale(const VisibilityMatrix& matrix, const ScaleOptions& options, unsigned threads) {
  const SparsePoints points(matrix);
  const ColumnSketches sketches(points, options.sketch_bits, threads);
  const NeighbourLists lists = nearby_points(points, sketches, options.nearby, threads);
  return points.order_of_columns(visits_at_scale(points, sketches, lists, options.nearby.seed, threads));
}

}  // namespace vismat
