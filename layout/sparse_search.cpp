// ALGORITHM. 2-opt [Croes 1958] and Or-opt [Or 1976: ways of up to 3 points move, either way around] as in
// layout/tour.cpp, over an array with a queue of points whose edges changed. What is different at this size:
// - an exact distance costs microseconds, so a move is first tried on the sketches: they bound the new edge
//   from below, hence the gain from above, and what cannot gain is given up before anything exact is
//   computed;
// - distances are kept in a direct-mapped table, as most are of tour edges asked for again and again;
// - flips are of the shorter side and refused above a limit [Johnson & McGeoch 1997 use 50000 for 10^6
//   points]: the tours come from greedy edges and have few long improvements left.
#include "layout/sparse_search.h"

#include <algorithm>
#include <utility>

namespace vismat {
namespace {

using Tour = std::vector<std::uint32_t>;

class Search {
 public:
  Search(const SparsePoints& points, const ColumnSketches& sketches, const NeighbourLists& lists, Tour tour,
         const LocalMoves& moves)
      : points_(points),
        sketches_(sketches),
        lists_(lists),
        moves_(moves),
        order_(std::move(tour)),
        place_(order_.size()),
        queued_(order_.size(), true),
        known_(std::size_t{1} << 21) {
    for (std::uint32_t i = 0; i < size(); ++i) place_[order_[i]] = i;
  }

  Tour run() {
    std::vector<std::uint32_t> queue = order_, following;
    while (!queue.empty()) {
      for (const std::uint32_t p : queue) {
        queued_[p] = false;
        if (p == points_.zero()) continue;  // it has no list; its neighbours look after it
        while (improve(p)) {
        }
      }
      following.swap(pushed_);
      pushed_.clear();
      queue.swap(following);
    }
    return std::move(order_);
  }

 private:
  std::uint32_t size() const { return static_cast<std::uint32_t>(order_.size()); }
  std::uint32_t next(std::uint32_t p) const {
    return place_[p] + 1 == size() ? order_[0] : order_[place_[p] + 1];
  }
  std::uint32_t prev(std::uint32_t p) const { return place_[p] == 0 ? order_.back() : order_[place_[p] - 1]; }
  std::uint32_t steps(std::uint32_t from, std::uint32_t to) const {  // places, onwards
    return to >= from ? to - from : to + size() - from;
  }
  void push(std::uint32_t p) {
    if (queued_[p]) return;
    queued_[p] = true;
    pushed_.push_back(p);
  }

  std::int64_t distance(std::uint32_t a, std::uint32_t b) {
    if (a > b) std::swap(a, b);
    const std::uint64_t pair = std::uint64_t{a} << 32 | b;
    Known& known = known_[(pair * 0x9e3779b97f4a7c15u) >> 43];
    if (known.pair != pair) known = {pair, points_.distance(a, b)};
    return known.distance;
  }
  // Whether an edge could be shorter than `limit`; if so, *length is its length, exactly.
  bool shorter(std::uint32_t a, std::uint32_t b, std::int64_t limit, std::int64_t* length) {
    if (limit <= 0) return false;
    const auto most = static_cast<std::uint32_t>(limit - 1);
    if (sketches_.lower_bound(a, b, most) > most) return false;
    *length = distance(a, b);
    return *length < limit;
  }

  // Edges a-b and c-d become a-c and b-d; going one way around, b follows a and d follows c.
  void exchange(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    const bool forward = next(a) == b;
    std::uint32_t i = place_[forward ? b : a], j = place_[forward ? c : d];
    std::uint32_t inside = steps(i, j) + 1;
    if (2 * std::uint64_t{inside} > size()) {  // turning the rest around gives the same closed tour
      std::swap(i, j);
      i = i + 1 == size() ? 0 : i + 1;
      j = j == 0 ? size() - 1 : j - 1;
      inside = size() - inside;
    }
    for (std::uint32_t swaps = inside / 2; swaps > 0; --swaps) {
      std::swap(order_[i], order_[j]);
      place_[order_[i]] = i;
      place_[order_[j]] = j;
      i = i + 1 == size() ? 0 : i + 1;
      j = j == 0 ? size() - 1 : j - 1;
    }
  }
  bool too_far(std::uint32_t a, std::uint32_t b) const {
    const std::uint32_t apart = steps(place_[a], place_[b]);
    return std::min(apart, size() - apart) > moves_.longest_flip;
  }

  bool improve(std::uint32_t p) {
    for (const bool forward : {true, false}) {
      if (two_opt(p, forward)) return true;
    }
    for (const bool forward : {true, false}) {
      if (moves_.or_opt && or_opt(p, forward)) return true;
    }
    return false;
  }

  // Gives up the edge from p to its successor (or predecessor), for one to a nearer point.
  bool two_opt(std::uint32_t p, bool forward) {
    const std::uint32_t q = forward ? next(p) : prev(p);
    const std::int64_t old_edge = distance(p, q);
    const std::size_t base = std::size_t{p} * lists_.per_point;
    for (std::uint32_t i = 0; i < lists_.per_point; ++i) {
      const std::int64_t gained = old_edge - lists_.distances[base + i];
      if (gained <= 0) return false;
      const std::uint32_t c = lists_.ids[base + i], d = forward ? next(c) : prev(c);
      if (c == q || d == p || too_far(p, c)) continue;
      std::int64_t closing = 0;
      if (!shorter(q, d, gained + distance(c, d), &closing)) continue;
      exchange(p, q, c, d);
      for (const std::uint32_t t : {p, q, c, d}) push(t);
      return true;
    }
    return false;
  }

  // Moves a way of 1 to 3 points that begins in p to beside a near point c, p next to c.
  bool or_opt(std::uint32_t p, bool forward) {
    const auto step = [&](std::uint32_t t) { return forward ? next(t) : prev(t); };
    const auto back = [&](std::uint32_t t) { return forward ? prev(t) : next(t); };
    const std::uint32_t before = back(p);
    const std::int64_t given_up = distance(before, p);
    const std::size_t base = std::size_t{p} * lists_.per_point;
    std::uint32_t way[3] = {p, p, p};
    for (std::uint32_t length = 1; length <= 3; ++length) {
      if (length > 1) way[length - 1] = step(way[length - 2]);
      const std::uint32_t end = way[length - 1], after = step(end);
      if (after == before) return false;
      const std::int64_t opened = given_up + distance(end, after);
      std::int64_t closing = 0;
      if (!shorter(before, after, opened, &closing)) continue;
      for (std::uint32_t i = 0; i < lists_.per_point; ++i) {
        const std::int64_t gained = opened - closing - lists_.distances[base + i];
        if (gained <= 0) break;
        const std::uint32_t c = lists_.ids[base + i];
        if (c == way[0] || (length > 1 && c == way[1]) || (length > 2 && c == way[2]) || too_far(p, c))
          continue;
        for (const bool beyond : {true, false}) {  // the new place: between c and step(c), or back(c) and c
          const std::uint32_t other = beyond ? step(c) : back(c);
          if ((c == before && beyond) || (c == after && !beyond)) continue;
          std::int64_t joining = 0;
          if (!shorter(end, other, gained + distance(c, other), &joining)) continue;
          const std::uint32_t low = beyond ? c : other, high = beyond ? other : c;
          exchange(before, p, low, high);           // before low .. after end .. p high
          exchange(before, low, after, end);        // before after .. low end .. p high
          if (beyond) exchange(low, end, p, high);  // p beside c
          for (const std::uint32_t t : {before, after, p, end, c, other}) push(t);
          return true;
        }
      }
    }
    return false;
  }

  struct Known {
    std::uint64_t pair = ~std::uint64_t{0};
    std::uint32_t distance = 0;
  };
  const SparsePoints& points_;
  const ColumnSketches& sketches_;
  const NeighbourLists& lists_;
  LocalMoves moves_;
  Tour order_;
  std::vector<std::uint32_t> place_, pushed_;
  std::vector<bool> queued_;
  std::vector<Known> known_;
};

}  // namespace

std::vector<std::uint32_t> improve_tour(const SparsePoints& points, const ColumnSketches& sketches,
                                        const NeighbourLists& lists, std::vector<std::uint32_t> tour,
                                        const LocalMoves& moves) {
  if (tour.size() < 8) return tour;
  return Search(points, sketches, lists, std::move(tour), moves).run();
}

}  // namespace vismat
