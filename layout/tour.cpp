// ALGORITHM of polish(). Local search by 2-opt [Croes 1958] and Or-opt [Or 1976: ways of up to 3 points move,
// either way around] over the candidate lists, points whose edges changed waiting in a queue, the others left
// alone (don't-look bits [Bentley 1992]). Then iterated: two neighbouring ways of up to 50 points change
// places, a double bridge that no 2-opt or Or-opt move undoes; the search repairs what the kick touched; if
// the tour is longer for it, the flips are taken back from a log. The kick is local, so a round costs
// microseconds whatever the size. All moves are flips of an array, of the shorter side.
//
// Measured (bench/orders): artificial 1, 1365 columns: 431245 runs at the first local optimum, 422911 after
// 50 kicks a point, 0.43 % above the Held-Karp bound.
//
// Breaks where lists hold nothing but duplicates at distance 0: collapse equal columns first, as best_order
// does.
#include "layout/tour.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <numeric>
#include <utility>

#include "matrix/random.h"

namespace vismat {
namespace {

// A tour in an array, with each point's place: next, prev and between in O(1), a flip in O(its shorter side).
class ArrayTour {
 public:
  explicit ArrayTour(Tour order) : order_(std::move(order)), place_(order_.size()) {
    for (std::uint32_t i = 0; i < size(); ++i) place_[order_[i]] = i;
  }
  std::uint32_t size() const { return static_cast<std::uint32_t>(order_.size()); }
  std::uint32_t next(std::uint32_t p) const {
    return place_[p] + 1 == size() ? order_[0] : order_[place_[p] + 1];
  }
  std::uint32_t prev(std::uint32_t p) const { return place_[p] == 0 ? order_.back() : order_[place_[p] - 1]; }
  std::uint32_t at(std::uint32_t place) const { return order_[place]; }
  /// Edges a-b and c-d become a-c and b-d; going one way around, b follows a and d follows c.
  void exchange(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    const bool forward = next(a) == b;
    std::uint32_t i = place_[forward ? b : a], j = place_[forward ? c : d];
    const std::uint32_t inside = (j >= i ? j - i : j + size() - i) + 1;
    if (2 * inside > size()) {  // turning the rest around gives the same closed tour
      std::swap(i, j);
      i = i + 1 == size() ? 0 : i + 1;
      j = j == 0 ? size() - 1 : j - 1;
    }
    swap_ends(i, j);
    log_.emplace_back(i, j);
  }
  void forget() { log_.clear(); }
  void undo() {
    for (; !log_.empty(); log_.pop_back()) swap_ends(log_.back().first, log_.back().second);
  }
  const Tour& order() const { return order_; }

 private:
  /// Turns what stands from place i on to place j around; doing it again undoes it.
  void swap_ends(std::uint32_t i, std::uint32_t j) {
    const std::uint32_t inside = (j >= i ? j - i : j + size() - i) + 1;
    for (std::uint32_t swaps = inside / 2; swaps > 0; --swaps) {
      std::swap(order_[i], order_[j]);
      place_[order_[i]] = i;
      place_[order_[j]] = j;
      i = i + 1 == size() ? 0 : i + 1;
      j = j == 0 ? size() - 1 : j - 1;
    }
  }
  Tour order_;
  std::vector<std::uint32_t> place_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> log_;  // of places turned around
};

class LocalSearch {
 public:
  LocalSearch(const ColumnPoints& points, const NeighbourLists& lists, Tour tour)
      : points_(points), lists_(lists), tour_(std::move(tour)), queued_(tour_.size(), false) {}

  void push(std::uint32_t p) {
    if (queued_[p]) return;
    queued_[p] = true;
    queue_.push_back(p);
  }
  // To a local optimum; returns what was saved.
  std::int64_t run() {
    std::int64_t saved = 0;
    for (std::size_t first = 0; first < queue_.size(); ++first) {
      const std::uint32_t p = queue_[first];
      queued_[p] = false;
      while (const std::int64_t gain = improve(p)) saved += gain;
    }
    queue_.clear();
    return saved;
  }
  const ArrayTour& tour() const { return tour_; }
  std::int64_t distance(std::uint32_t a, std::uint32_t b) const { return points_.distance(a, b); }

  // Swaps the two neighbouring ways a .. b and c .. d, c = next b: a double bridge. Returns what it saves.
  std::int64_t swap_ways(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    const std::uint32_t before = tour_.prev(a), after = tour_.next(d);
    const std::int64_t gain = distance(before, a) + distance(b, c) + distance(d, after) -
                              distance(before, c) - distance(d, a) - distance(b, after);
    tour_.exchange(before, a, d, after);  // before d .. c b .. a after
    tour_.exchange(before, d, c, b);      // before c .. d b .. a after
    tour_.exchange(d, b, a, after);       // before c .. d a .. b after
    for (const std::uint32_t p : {before, a, b, c, d, after}) push(p);
    return gain;
  }
  void forget() { tour_.forget(); }
  void undo() { tour_.undo(); }

 private:
  std::int64_t improve(std::uint32_t p) {
    for (const bool forward : {true, false}) {
      if (const std::int64_t gain = two_opt(p, forward)) return gain;
    }
    for (const bool forward : {true, false}) {
      if (const std::int64_t gain = or_opt(p, forward)) return gain;
    }
    return 0;
  }

  // Gives up the edge from p to its successor (or predecessor), for one to a nearer point.
  std::int64_t two_opt(std::uint32_t p, bool forward) {
    const std::uint32_t q = forward ? tour_.next(p) : tour_.prev(p);
    const std::int64_t old_edge = distance(p, q);
    const std::size_t base = std::size_t{p} * lists_.per_point;
    for (std::uint32_t i = 0; i < lists_.per_point; ++i) {
      const std::uint32_t c = lists_.ids[base + i];
      const std::int64_t first_gain = old_edge - lists_.distances[base + i];
      if (first_gain <= 0) break;
      const std::uint32_t d = forward ? tour_.next(c) : tour_.prev(c);
      if (c == q || d == p) continue;
      const std::int64_t gain = first_gain + distance(c, d) - distance(q, d);
      if (gain <= 0) continue;
      tour_.exchange(p, q, c, d);
      for (const std::uint32_t t : {p, q, c, d}) push(t);
      return gain;
    }
    return 0;
  }

  // Moves a way of 1 to 3 points that ends in p to beside a near point c, p next to c.
  std::int64_t or_opt(std::uint32_t p, bool forward) {
    const auto step = [&](std::uint32_t t) { return forward ? tour_.next(t) : tour_.prev(t); };
    const auto back = [&](std::uint32_t t) { return forward ? tour_.prev(t) : tour_.next(t); };
    const std::uint32_t before = back(p);  // the edge before - p goes
    const std::int64_t given_up = distance(before, p);
    std::uint32_t end = p;
    for (int length = 1; length <= 3; ++length, end = step(end)) {
      const std::uint32_t after = step(end);
      if (after == before) return 0;
      const std::int64_t removed = given_up + distance(end, after) - distance(before, after);
      if (removed <= 0) continue;
      const std::size_t base = std::size_t{p} * lists_.per_point;
      for (std::uint32_t i = 0; i < lists_.per_point; ++i) {
        const std::uint32_t c = lists_.ids[base + i];
        const std::int64_t gain_so_far = removed - lists_.distances[base + i];
        if (gain_so_far <= 0) break;
        bool inside = false;
        for (std::uint32_t t = p;; t = step(t)) {
          inside = inside || t == c;
          if (t == end) break;
        }
        if (inside) continue;
        for (const bool beyond : {true, false}) {  // the new place: between c and step(c), or back(c) and c
          const std::uint32_t other = beyond ? step(c) : back(c);
          if ((c == before && beyond) || (c == after && !beyond)) continue;
          const std::int64_t gain = gain_so_far + distance(c, other) - distance(end, other);
          if (gain <= 0) continue;
          move_way(before, p, end, after, c, other, beyond);
          for (const std::uint32_t t : {before, after, p, end, c, other}) push(t);
          return gain;
        }
      }
    }
    return 0;
  }

  // before p .. end after, going one way around, and further on the edge to open: c other if `beyond`, else
  // other c.
  void move_way(std::uint32_t before, std::uint32_t p, std::uint32_t end, std::uint32_t after,
                std::uint32_t c, std::uint32_t other, bool beyond) {
    const std::uint32_t low = beyond ? c : other, high = beyond ? other : c;
    tour_.exchange(before, p, low, high);           // before low .. after end .. p high
    tour_.exchange(before, low, after, end);        // before after .. low end .. p high
    if (beyond) tour_.exchange(low, end, p, high);  // p beside c
  }

  const ColumnPoints& points_;
  const NeighbourLists& lists_;
  ArrayTour tour_;
  std::vector<bool> queued_;
  std::vector<std::uint32_t> queue_;
};

// Which fragment's end a point is, and joins: union-find with path halving.
class Fragments {
 public:
  explicit Fragments(std::uint32_t size) : degree_(size, 0), root_(size), links_(size, {none, none}) {
    std::iota(root_.begin(), root_.end(), 0u);
  }
  bool try_join(std::uint32_t a, std::uint32_t b) {
    if (degree_[a] == 2 || degree_[b] == 2 || find(a) == find(b)) return false;
    root_[find(a)] = find(b);
    links_[a][degree_[a]++] = b;
    links_[b][degree_[b]++] = a;
    return true;
  }
  unsigned degree(std::uint32_t p) const { return degree_[p]; }
  // Along the one path that is left.
  Tour walk() const {
    const auto start = static_cast<std::uint32_t>(
        std::find_if(degree_.begin(), degree_.end(), [](auto d) { return d < 2; }) - degree_.begin());
    Tour tour;
    for (std::uint32_t at = start, from = none; tour.size() < root_.size();) {
      tour.push_back(at);
      const std::uint32_t to = links_[at][0] != from ? links_[at][0] : links_[at][1];
      from = at;
      at = to;
    }
    return tour;
  }
  static constexpr std::uint32_t none = 0xffffffff;

 private:
  std::uint32_t find(std::uint32_t p) {
    while (root_[p] != p) p = root_[p] = root_[root_[p]];
    return p;
  }
  std::vector<std::uint8_t> degree_;
  std::vector<std::uint32_t> root_;
  std::vector<std::array<std::uint32_t, 2>> links_;
};

}  // namespace

std::uint64_t tour_length(const ColumnPoints& points, const Tour& tour) {
  std::uint64_t length = 0;
  for (std::size_t i = 0; i < tour.size(); ++i)
    length += points.distance(tour[i], tour[(i + 1) % tour.size()]);
  return length;
}

Permutation order_of_tour(const Tour& tour) {
  const std::size_t zero =
      static_cast<std::size_t>(std::max_element(tour.begin(), tour.end()) - tour.begin());
  std::vector<std::uint32_t> order;
  for (std::size_t i = 1; i < tour.size(); ++i) order.push_back(tour[(zero + i) % tour.size()]);
  return Permutation::from_old_of_new(std::move(order));
}

Tour tour_of_order(const Permutation& order) {
  Tour tour = order.old_of_new();
  tour.push_back(order.size());
  return tour;
}

Tour nearest_neighbour_tour(const ColumnPoints& points) {
  std::vector<std::uint32_t> left(points.size());
  std::iota(left.begin(), left.end(), 0u);
  Tour tour = {points.zero()};
  while (!left.empty()) {
    std::uint32_t best = 0xffffffff;
    std::size_t best_at = 0;
    for (std::size_t i = 0; i < left.size(); ++i) {
      const std::uint32_t d = points.distance(tour.back(), left[i], best);
      if (d < best || (d == best && left[i] < left[best_at])) best = d, best_at = i;
    }
    tour.push_back(left[best_at]);
    left[best_at] = left.back();
    left.pop_back();
  }
  return tour;
}

Tour greedy_edge_tour(const ColumnPoints& points, const NeighbourLists& neighbours) {
  struct Edge {
    std::uint32_t distance, a, b;
    auto operator<=>(const Edge&) const = default;
  };
  const std::uint32_t count = points.size() + 1;
  Fragments fragments(count);
  const auto join_all = [&](std::vector<Edge>& edges) {
    std::sort(edges.begin(), edges.end());
    for (const Edge& e : edges) fragments.try_join(e.a, e.b);
  };
  std::vector<Edge> edges;
  for (std::uint32_t p = 0; p < count; ++p) {
    for (std::uint32_t i = 0; i < neighbours.per_point; ++i) {
      const std::uint32_t q = neighbours.ids[std::size_t{p} * neighbours.per_point + i];
      edges.push_back(
          {neighbours.distances[std::size_t{p} * neighbours.per_point + i], std::min(p, q), std::max(p, q)});
    }
  }
  join_all(edges);
  std::vector<std::uint32_t> ends;
  for (std::uint32_t p = 0; p < count; ++p) {
    if (fragments.degree(p) < 2) ends.push_back(p);
  }
  edges.clear();
  for (std::size_t i = 0; i < ends.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j)
      edges.push_back({points.distance(ends[i], ends[j]), ends[j], ends[i]});
  }
  join_all(edges);
  return fragments.walk();
}

Tour polish(const ColumnPoints& points, const NeighbourLists& neighbours, Tour tour,
            const PolishOptions& options) {
  const auto count = static_cast<std::uint32_t>(tour.size());
  if (count < 8) return tour;
  LocalSearch search(points, neighbours, std::move(tour));
  for (std::uint32_t place = 0; place < count; ++place) search.push(search.tour().at(place));
  search.run();
  search.forget();
  Random random(options.seed);
  const auto start = std::chrono::steady_clock::now();
  const auto kicks = static_cast<std::uint64_t>(options.kicks_per_point * count);
  const std::uint32_t longest = std::min(50u, (count - 2) / 3);
  for (std::uint64_t kick = 0; kick < kicks; ++kick) {
    if (options.seconds > 0 && kick % 256 == 0 &&
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() > options.seconds) {
      break;
    }
    const std::uint32_t first = random.below(count), one = 1 + random.below(longest),
                        two = 1 + random.below(longest);
    const auto at = [&](std::uint32_t steps) { return search.tour().at((first + steps) % count); };
    std::int64_t saved = search.swap_ways(at(0), at(one - 1), at(one), at(one + two - 1));
    saved += search.run();
    if (saved < 0) {
      search.undo();
    } else {
      search.forget();
    }
  }
  return search.tour().order();
}

}  // namespace vismat
