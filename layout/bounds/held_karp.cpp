// ALGORITHM. Held and Karp's lower bound. A 1-tree is a spanning tree of the columns and two more edges from the zero
// point. Every closed tour is a 1-tree, so the cheapest 1-tree costs no more than the cheapest tour. Adding p_i to
// every edge at i adds 2 sum(p) to every tour and changes which 1-tree is cheapest; the best bound over all p is Held
// and Karp's. We climb along the subgradient, degree - 2, with 0.3 of the last one mixed in. The steps shrink when
// nothing is gained. We begin with the two-nearest bound's potentials, minus half the second nearest distance.
//
// Pricing. The ascent looks only at candidate edges: the nearest few of each point and those of a known tour. Its
// result is no bound, since a pair outside the candidates may have become cheap. So its best potentials are priced over
// all pairs. A pair can be in the cheapest spanning tree only if it costs less than the most expensive edge on the
// candidate tree's path between its ends (the cycle property). The pairs that are this cheap join the candidates, whose
// cheapest 1-tree is then that of the complete graph, which is a bound. Kruskal's merges, laid side by side, put the
// points in a row in which that most expensive edge is the maximum of the merges between two places. So pricing is a
// scan of each row of the distance table. The next round continues the ascent over the larger graph.
//
// PROOF for integers. Distances are scaled by `scale` and potentials are integers of that scale, so a 1-tree's weight W
// is exact and every tour T satisfies scale * length(T) >= W - 2 sum(p). The length is twice the number of runs, hence
// runs >= (W - 2 sum(p)) / (2 scale), rounded up, whatever the potentials: the floating-point steps that led to them do
// not matter. Distances that are cut off at 65535 only lower W.
//
// Measured (bench order-scale, two cores that others used as well): power plant at 1/16, 24,400 points, 8 rounds of 50
// steps in 22 s, the scale tour 3.7 % above; at 1/64, 5,900 points, 1.5 s and 3.8 %. At the former size a step takes 3
// ms, a pricing half a second, the table of pairs 3 s; an ascent over all pairs took 0.9 s for each step.
//
// NOT valid, though tempting: the spanning tree of the candidates alone; sums of bounds over blocks of columns (edges
// between blocks may replace edges within).
#include "layout/bounds/held_karp.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <utility>

#include "matrix/base/union_find.h"
#include "matrix/points/pair_distances.h"

namespace vismat {
namespace {

constexpr std::int32_t scale = 256;
constexpr double most_potential = 2.6e8;  // twice that and 65535 * scale fit into 31 bits

// Ascending by the upper half; `buffer` is for its use.
void sort_by_high_word(std::vector<std::uint64_t>& keys, std::vector<std::uint64_t>& buffer) {
  buffer.resize(keys.size());
  for (const int shift : {32, 43, 54}) {
    std::uint32_t place[2049] = {};
    for (const std::uint64_t key : keys) ++place[(key >> shift & 2047) + 1];
    std::partial_sum(place, place + 2049, place);
    for (const std::uint64_t key : keys) buffer[place[key >> shift & 2047]++] = key;
    keys.swap(buffer);
  }
}

// Shows each row of the table of distances, in parallel.
using Pass = std::function<void(const PairDistances::Take&)>;

struct Edge {
  std::uint32_t a, b, distance;  // a < b
  auto operator<=>(const Edge&) const = default;
};

// The cheapest 1-trees of a graph of candidate edges, which connects all points.
class OneTrees {
 public:
  explicit OneTrees(const SparsePoints& points) : points_(points) {}

  void add(const std::vector<Edge>& edges) {
    const auto middle = static_cast<std::ptrdiff_t>(edges_.size());
    edges_.insert(edges_.end(), edges.begin(), edges.end());
    std::sort(edges_.begin() + middle, edges_.end());
    std::inplace_merge(edges_.begin(), edges_.begin() + middle, edges_.end());
    edges_.erase(std::unique(edges_.begin(), edges_.end()), edges_.end());
  }

  // The cheapest one's length without the potentials, scaled; fills in the degrees. `merged` is told each
  // tree edge's components and weight, cheapest first.
  template <typename Merged>
  std::int64_t cheapest(const std::vector<std::int32_t>& potential, std::vector<std::int32_t>& degree,
                        const Merged& merged) {
    const std::uint32_t n = points_.size();
    keys_.clear();
    for (std::uint32_t e = 0; e < edges_.size(); ++e) {
      const Edge& edge = edges_[e];
      const std::int32_t weight =
          static_cast<std::int32_t>(edge.distance) * scale + potential[edge.a] + potential[edge.b];
      keys_.push_back(std::uint64_t{static_cast<std::uint32_t>(weight) ^ 0x80000000u} << 32 | e);
    }
    sort_by_high_word(keys_, buffer_);
    degree.assign(n + 1, 0);
    UnionFind components(n);
    std::int64_t length = 0;
    std::uint32_t left = n - 1;
    for (std::size_t i = 0; left > 0; ++i) {
      const Edge& edge = edges_[keys_[i] & 0xffffffff];
      const std::uint32_t a = components.find(edge.a), b = components.find(edge.b);
      if (a == b) continue;
      const auto weight = static_cast<std::int32_t>(static_cast<std::uint32_t>(keys_[i] >> 32) ^ 0x80000000u);
      components.join(b, a);
      merged(a, b, weight, edge);
      length += weight;
      ++degree[edge.a];
      ++degree[edge.b];
      --left;
    }
    using Spoke = std::pair<std::int64_t, std::uint32_t>;
    Spoke first(std::numeric_limits<std::int64_t>::max(), 0), second = first;
    for (std::uint32_t p = 0; p < n; ++p) {
      const Spoke spoke(std::int64_t{scale} * points_.weight(p) + potential[p] + potential[n], p);
      if (spoke < first)
        second = std::exchange(first, spoke);
      else
        second = std::min(second, spoke);
    }
    ++degree[first.second];
    ++degree[second.second];
    degree[n] = 2;
    return length + first.first + second.first -
           2 * std::accumulate(potential.begin(), potential.end(), std::int64_t{0});
  }

 private:
  const SparsePoints& points_;
  std::vector<Edge> edges_;
  std::vector<std::uint64_t> keys_, buffer_;
};

// Points in a row in which the dearest edge on the tree's path between two of them is the dearest step
// between their places.
struct Linkage {
  std::vector<std::uint32_t> points;
  std::vector<std::int32_t> step;  // from the place before

  Linkage(OneTrees& trees, const std::vector<std::int32_t>& potential) {
    const auto n = static_cast<std::uint32_t>(potential.size() - 1);
    std::vector<std::uint32_t> next(n), last(n);
    std::vector<std::int32_t> into(n, 0), degree;
    std::iota(next.begin(), next.end(), 0u);
    std::iota(last.begin(), last.end(), 0u);
    std::uint32_t root = 0;
    trees.cheapest(potential, degree,
                   [&](std::uint32_t a, std::uint32_t b, std::int32_t weight, const Edge&) {
                     next[last[a]] = b;  // a's own first point is a, as it stays the root
                     into[b] = weight;
                     last[a] = last[b];
                     root = a;
                   });
    for (std::uint32_t p = root, i = 0; i < n; ++i, p = next[p]) {
      points.push_back(p);
      step.push_back(into[p]);
    }
  }
};

// The pairs that are cheaper than the dearest edge between their ends.
std::vector<Edge> cheap_pairs(std::uint32_t n, const Pass& pass, const std::vector<std::int32_t>& potential,
                              const Linkage& linkage) {
  constexpr std::int32_t lowest = std::numeric_limits<std::int32_t>::min();
  std::vector<std::uint32_t> place(n);
  for (std::uint32_t i = 0; i < n; ++i) place[linkage.points[i]] = i;
  std::vector<std::vector<Edge>> found(n);
  pass([&](std::uint32_t p, std::span<const Distance16> distances) {
    struct Cheap {
      std::uint32_t point;
      std::int32_t cost, dearest_since;
    };
    std::vector<Cheap> cheap;
    std::int32_t dearest = lowest;
    for (std::uint32_t i = place[p] + 1; i < n; ++i) {
      dearest = std::max(dearest, linkage.step[i]);
      if (!cheap.empty()) cheap.back().dearest_since = std::max(cheap.back().dearest_since, linkage.step[i]);
      const std::uint32_t q = linkage.points[i];
      const std::int32_t cost = distances[q] * scale + potential[p] + potential[q];
      if (cost >= dearest) continue;
      // Of two such pairs the dearer is in no cheapest tree if the way between their ends is cheaper still.
      while (!cheap.empty() && cheap.back().cost >= std::max(cost, cheap.back().dearest_since)) {
        const std::int32_t since = cheap.back().dearest_since;
        cheap.pop_back();
        if (!cheap.empty()) cheap.back().dearest_since = std::max(cheap.back().dearest_since, since);
      }
      if (!cheap.empty() && cost >= std::max(cheap.back().cost, cheap.back().dearest_since)) continue;
      cheap.push_back({q, cost, lowest});
    }
    for (const Cheap& c : cheap)
      found[p].push_back({std::min(p, c.point), std::max(p, c.point), distances[c.point]});
  });
  std::vector<Edge> edges;
  for (const auto& of_point : found) edges.insert(edges.end(), of_point.begin(), of_point.end());
  return edges;
}

// Joins separate components by the cheapest pairs, as in a cheapest spanning tree [Boruvka 1926].
std::vector<Edge> joining_pairs(std::uint32_t n, const Pass& pass, const std::vector<std::int32_t>& potential,
                                UnionFind& components) {
  std::vector<Edge> edges;
  for (;;) {
    std::vector<std::uint32_t> component(n);
    for (std::uint32_t p = 0; p < n; ++p) component[p] = components.find(p);
    if (std::all_of(component.begin(), component.end(), [&](std::uint32_t c) { return c == component[0]; }))
      return edges;
    struct Candidate {
      std::int64_t cost = std::numeric_limits<std::int64_t>::max();
      Edge edge{};
      auto operator<=>(const Candidate&) const = default;
    };
    std::vector<Candidate> of_point(n), of_component(n);
    pass([&](std::uint32_t p, std::span<const Distance16> distances) {
      std::int32_t least = std::numeric_limits<std::int32_t>::max();
      std::uint32_t at = p;
      for (std::uint32_t q = 0; q < n; ++q) {
        const std::int32_t cost = distances[q] * scale + potential[q];
        if (cost < least && component[q] != component[p]) {
          least = cost;
          at = q;
        }
      }
      of_point[p] = {std::int64_t{least} + potential[p], {std::min(p, at), std::max(p, at), distances[at]}};
    });
    for (std::uint32_t p = 0; p < n; ++p)
      of_component[component[p]] = std::min(of_component[component[p]], of_point[p]);
    for (std::uint32_t c = 0; c < n; ++c) {
      if (component[c] != c) continue;
      const Edge& edge = of_component[c].edge;
      const std::uint32_t a = components.find(edge.a), b = components.find(edge.b);
      if (a == b) continue;
      components.join(a, b);
      edges.push_back(edge);
    }
  }
}

// The nearest few of each point; second[p] is the distance of the second nearest.
std::vector<Edge> nearest_pairs(std::uint32_t n, const Pass& pass, std::uint32_t neighbours,
                                std::vector<std::uint32_t>& second) {
  const std::uint32_t k = std::min(neighbours, n - 1);
  std::vector<Edge> edges(std::size_t{n} * k);
  second.assign(n, 0);
  pass([&](std::uint32_t p, std::span<const Distance16> distances) {
    std::vector<std::uint64_t> nearest;  // distance, then point
    std::uint64_t limit = ~std::uint64_t{0};
    const auto keep = [&] {
      std::nth_element(nearest.begin(), nearest.begin() + k - 1, nearest.end());
      nearest.resize(k);
      limit = nearest[k - 1];
    };
    for (std::uint32_t q = 0; q < n; ++q) {
      const std::uint64_t key = std::uint64_t{distances[q]} << 32 | q;
      if (key >= limit || q == p) continue;
      nearest.push_back(key);
      if (nearest.size() == 4 * std::size_t{k}) keep();
    }
    if (nearest.size() > k) keep();
    std::sort(nearest.begin(), nearest.end());
    for (std::uint32_t i = 0; i < k; ++i) {
      const auto q = static_cast<std::uint32_t>(nearest[i]);
      edges[std::size_t{p} * k + i] = {std::min(p, q), std::max(p, q),
                                       static_cast<std::uint32_t>(nearest[i] >> 32)};
    }
    second[p] = static_cast<std::uint32_t>(nearest[std::min(1u, k - 1)] >> 32);
  });
  return edges;
}

std::vector<Edge> tour_edges(const SparsePoints& points, std::span<const std::uint32_t> visits) {
  std::vector<Edge> edges;
  for (std::size_t i = 1; i < visits.size(); ++i) {
    const auto [a, b] = std::minmax(visits[i - 1], visits[i]);
    edges.push_back({a, b, std::min(points.distance(a, b), 65535u)});
  }
  return edges;
}

// Climbs; remembers the best potentials on the graph as it is.
class Ascent {
 public:
  Ascent(std::vector<std::int32_t> start, double known_length)
      : potential_(std::move(start)),
        best_potential_(potential_),
        before_(potential_.size(), 2),
        known_(known_length) {}

  // False if there is nothing more to be gained on this graph.
  bool step(OneTrees& trees) {
    const auto length = static_cast<double>(trees.cheapest(potential_, degree_, [](auto...) {}));
    if (length > best_) {
      best_ = length;
      best_potential_ = potential_;
      since_gain_ = 0;
    } else if (++since_gain_ >= 8) {
      agility_ = agility_ < 1e-3 ? .3 : .7 * agility_;  // stuck: on with longer steps again
      since_gain_ = 0;
      potential_ = best_potential_;
    }
    double norm = 0;
    for (const std::int32_t d : degree_) norm += static_cast<double>(d - 2) * (d - 2);
    if (norm == 0) return false;  // the 1-tree is a tour
    const double stride = agility_ * std::max(known_ - length, 1e-4 * known_) / norm;
    for (std::size_t p = 0; p < potential_.size(); ++p) {
      const double moved = potential_[p] + stride * (.7 * (degree_[p] - 2) + .3 * (before_[p] - 2));
      potential_[p] =
          static_cast<std::int32_t>(std::nearbyint(std::clamp(moved, -most_potential, most_potential)));
    }
    before_ = degree_;
    return true;
  }
  const std::vector<std::int32_t>& best_potential() const { return best_potential_; }
  // The graph has grown: what was best on it is worth only that much.
  void revalue(std::int64_t length) {
    best_ = static_cast<double>(length);
    potential_ = best_potential_;
    since_gain_ = 0;
  }

 private:
  std::vector<std::int32_t> potential_, best_potential_, degree_, before_;
  double best_ = -std::numeric_limits<double>::infinity(), known_, agility_ = 1;
  int since_gain_ = 0;
};

}  // namespace

LowerBound held_karp_bound(const SparsePoints& points, std::span<const std::uint32_t> visits,
                           const HeldKarpOptions& options) {
  const std::uint32_t n = points.size();
  if (n < 2) return {n == 0 ? 0 : points.weight(0), {}};  // no 1-tree, and nothing to order
  const auto start = std::chrono::steady_clock::now();
  const auto in_time = [&] {
    const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - start;
    return options.seconds <= 0 || spent.count() < options.seconds;
  };
  const PairDistances pairs(points, options.pair_bytes, options.threads);
  struct OutOfTime {};
  // Passes over pairs that are kept take a second at most, the others hours at 400,000 points.
  const Pass pass = [&](const PairDistances::Take& take) {
    pairs.each_row(
        [&](std::uint32_t p, std::span<const Distance16> distances) {
          if (!pairs.kept() && !in_time()) throw OutOfTime{};
          take(p, distances);
        },
        options.threads);
  };
  LowerBound bound;
  try {
    OneTrees trees(points);
    trees.add(tour_edges(points, visits));
    std::vector<std::uint32_t> second;
    const auto nearest = nearest_pairs(n, pass, options.neighbours, second);
    trees.add(nearest);
    std::vector<std::int32_t> potential(n + 1, 0), degree;
    for (std::uint32_t p = 0; p < n; ++p) potential[p] = -scale / 2 * static_cast<std::int32_t>(second[p]);
    UnionFind components(n);
    for (const Edge& e : nearest) components.join(components.find(e.a), components.find(e.b));
    trees.add(joining_pairs(n, pass, potential, components));

    Ascent ascent(std::move(potential),
                  2 * scale * static_cast<double>(runs_of_visits(points, visits, options.threads)));
    const Progress progress =
        options.seconds > 0 ? Progress{} : begin_stage(options.stages, "Held-Karp bound");
    for (std::uint32_t round = 0; options.seconds > 0 ? round == 0 || in_time() : round < options.rounds;
         ++round) {
      for (std::uint32_t step = 0; step < options.steps && ascent.step(trees); ++step) {
      }
      const auto& best = ascent.best_potential();
      OneTrees priced = trees;
      priced.add(cheap_pairs(n, pass, best, Linkage(trees, best)));
      std::vector<Edge> tree;
      const std::int64_t length =
          priced.cheapest(best, degree, [&](auto, auto, auto, const Edge& edge) { tree.push_back(edge); });
      trees.add(tree);
      ascent.revalue(length);
      if (length > 0)
        bound.runs = std::max(bound.runs, static_cast<std::uint64_t>((length + 2 * scale - 1) / (2 * scale)));
      bound.history.push_back(bound.runs);
      if (progress) progress(round + 1, options.rounds);
    }
  } catch (const OutOfTime&) {  // keeps what is proven so far
  }
  return bound;
}

}  // namespace vismat
