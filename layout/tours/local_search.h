// Local search for tours: 3-opt over candidate lists, with kicks.
//
// ALGORITHM. Sequential 3-opt over candidate lists [Lin 1965; Johnson & McGeoch 1997]. t1-t2 is given up for t2-t3,
// with t3 near t2. Then t3-t4 is given up for t4-t1 (2-opt), or for t4-t5, with t5 near t4, and t5-t6 for t6-t1: that
// is 2-opt twice, or two parts of the tour that change places or are reversed where they are. Or-opt [Or 1976] is the
// case of short parts. A move is followed further only while it has gained up to an added edge, and the first gain is
// taken. Points whose edges changed wait in a queue, the others are left alone (don't-look bits [Bentley 1992]).
//
// Tried and found worse: 2-opt and Or-opt with parts of up to 3 points; parts of at most 10 points in a kick; kicks all
// over the tour. docs/orders.md has the figures.
#pragma once
#include <algorithm>
#include <bit>
#include <chrono>
#include <cstdint>
#include <initializer_list>
#include <utility>
#include <vector>

#include "layout/tours/array_tour.h"
#include "matrix/base/parallel.h"
#include "matrix/base/random.h"
#include "matrix/points/column_points.h"

namespace vismat {

/// The moves that a search may make.
struct LocalMoves {
  bool three_opt = true;  // else 2-opt alone
  /// No edge is added between points farther apart along the tour than this, which limits the parts to be reversed.
  std::uint32_t longest_flip = 25000;
};

/// Distances that are asked for again and again, such as those of tour edges: a few for each point, 8 bytes each.
class KnownDistances {
 public:
  explicit KnownDistances(std::uint32_t points)
      : each_(std::bit_floor(std::clamp((1u << 20) / (points + 1), 8u, 64u))),
        known_(std::size_t{points} * each_) {}
  /// Calls `measure()` if the distance is not known.
  template <typename Measure>
  std::uint32_t of(std::uint32_t a, std::uint32_t b, const Measure& measure) {
    if (a > b) std::swap(a, b);
    Known& known = known_[std::size_t{a} * each_ + (b * 2654435769u >> 16 & (each_ - 1))];
    if (known.other != b) known = {b, measure()};
    return known.distance;
  }

 private:
  struct Known {
    std::uint32_t other = 0xffffffff, distance = 0;
  };
  std::uint32_t each_;
  std::vector<Known> known_;
};

/// Distances has `std::int64_t distance(a, b)` and `bool below(a, b, limit, &length)`. The latter says whether the
/// distance is below a limit, which may be cheaper, and if so gives the distance.
template <typename Distances>
class LocalSearch {
 public:
  /// `lists` may leave out the last points; a distance of 0xffffffff ends a list. The tour has at least 8 points.
  LocalSearch(Distances distances, const NeighbourLists& lists, std::vector<std::uint32_t> tour,
              const LocalMoves& moves = {})
      : distances_(std::move(distances)),
        lists_(lists),
        moves_(moves),
        tour_(std::move(tour)),
        queued_(tour_.size(), false) {
    listed_ = lists.per_point == 0 ? 0 : static_cast<std::uint32_t>(lists.ids.size() / lists.per_point);
  }
  const ArrayTour& tour() const { return tour_; }

  /// Goes to a local optimum, from where kicks left the tour or, at first, from all points. Returns what was saved.
  std::int64_t run() {
    std::int64_t saved = 0;
    std::vector<std::uint32_t> queue;
    while (!pushed_.empty()) {
      queue.swap(pushed_);
      for (const std::uint32_t p : queue) {
        queued_[p] = false;
        while (const std::int64_t gain = p < listed_ ? improve(p) : 0) saved += gain;
      }
      queue.clear();
    }
    return saved;
  }
  void push_all() {
    for (const std::uint32_t p : tour_.order()) push(p);
  }
  /// The segment insertion of Or-3opt: the parts of `one` and `two` points from `place` on change places. Returns what
  /// it saves, which is mostly negative. Both parts and two more points must fit into the tour.
  std::int64_t kick(std::uint32_t place, std::uint32_t one, std::uint32_t two) {
    const auto at = [&](std::uint32_t steps) { return tour_.at((place + steps) % tour_.size()); };
    const std::uint32_t a = at(0), b = at(one - 1), c = at(one), d = at(one + two - 1);
    const std::uint32_t before = tour_.prev(a), after = tour_.next(d);
    const std::int64_t gain = distance(before, a) + distance(b, c) + distance(d, after) -
                              distance(before, c) - distance(d, a) - distance(b, after);
    swap_ways(before, a, b, c, d, after);
    return gain;
  }
  /// undo() leads back to the last mark().
  void mark() {
    marked_ = true;
    turned_.clear();
  }
  void undo() {
    for (; !turned_.empty(); turned_.pop_back()) tour_.turn(turned_.back());
  }

 private:
  using Point = std::uint32_t;
  std::int64_t distance(Point a, Point b) { return distances_.distance(a, b); }
  void push(Point p) {
    if (queued_[p]) return;
    queued_[p] = true;
    pushed_.push_back(p);
  }
  void exchange(Point a, Point b, Point c, Point d) {
    const ArrayTour::Way way = tour_.exchange(a, b, c, d);
    if (marked_) turned_.push_back(way);
  }
  bool too_far(Point a, Point b) const { return tour_.apart(a, b) > moves_.longest_flip; }

  std::int64_t improve(Point p) {
    const std::int64_t gain = improve(p, true);
    return gain != 0 ? gain : improve(p, false);
  }
  // Looks at the tour in the direction in which t2 follows t1.
  std::int64_t improve(Point t2, bool forward) {
    const auto next = [&](Point p) { return forward ? tour_.next(p) : tour_.prev(p); };
    const auto prev = [&](Point p) { return forward ? tour_.prev(p) : tour_.next(p); };
    const auto between = [&](Point from, Point p, Point to) {
      return forward ? tour_.steps(from, p) <= tour_.steps(from, to)
                     : tour_.steps(p, from) <= tour_.steps(to, from);
    };
    const Point t1 = prev(t2);
    const std::int64_t opened = distance(t1, t2);
    for (std::size_t i = std::size_t{t2} * lists_.per_point; i < std::size_t{t2 + 1} * lists_.per_point;
         ++i) {
      const std::int64_t gained = opened - lists_.distances[i];
      if (gained <= 0) return 0;
      const Point t3 = lists_.ids[i];
      if (t3 == t1 || too_far(t2, t3)) continue;
      for (const bool closes : {true, false}) {
        const Point t4 = closes ? prev(t3) : next(t3);
        if (t4 == t2) continue;
        const std::int64_t then = gained + distance(t3, t4);
        std::int64_t closing = 0;
        if (closes && distances_.below(t4, t1, then, closing)) {
          exchange(t1, t2, t4, t3);
          push_each({t1, t2, t3, t4});
          return then - closing;
        }
        if (!moves_.three_opt || t4 >= listed_) continue;
        for (std::size_t j = std::size_t{t4} * lists_.per_point; j < std::size_t{t4 + 1} * lists_.per_point;
             ++j) {
          const std::int64_t still = then - lists_.distances[j];
          if (still <= 0) break;
          const Point t5 = lists_.ids[j];
          if (t5 == t3 || too_far(t4, t5)) continue;
          if (closes) {
            const bool turned = between(t2, t5, t4);
            const Point t6 = turned ? next(t5) : prev(t5);
            if (t6 == t4 || !distances_.below(t6, t1, still + distance(t5, t6), closing)) continue;
            const std::int64_t gain = still + distance(t5, t6) - closing;
            exchange(t1, t2, t4, t3);
            exchange(t1, t4, t6, t5);
            push_each({t1, t2, t3, t4, t5, t6});
            return gain;
          }
          if (!between(t2, t5, t3)) continue;
          for (const bool swaps : {true, false}) {
            if (!swaps && t5 == t2) continue;
            const Point t6 = swaps ? next(t5) : prev(t5);
            if (!distances_.below(t6, t1, still + distance(t5, t6), closing)) continue;
            const std::int64_t gain = still + distance(t5, t6) - closing;
            if (swaps) {
              swap_ways(t1, t2, t5, t6, t3, t4);
            } else {  // t1 t6 .. t2 t3 .. t5 t4
              exchange(t1, t2, t6, t5);
              exchange(t2, t5, t3, t4);
              push_each({t1, t2, t3, t4, t5, t6});
            }
            return gain;
          }
        }
      }
    }
    return 0;
  }

  // before a .. b c .. d after, going one way around, becomes before c .. d a .. b after.
  void swap_ways(Point before, Point a, Point b, Point c, Point d, Point after) {
    exchange(before, a, d, after);  // before d .. c b .. a after
    exchange(before, d, c, b);      // before c .. d b .. a after
    exchange(d, b, a, after);       // before c .. d a .. b after
    push_each({before, a, b, c, d, after});
  }
  void push_each(std::initializer_list<Point> points) {
    for (const Point p : points) push(p);
  }

  Distances distances_;
  const NeighbourLists& lists_;
  LocalMoves moves_;
  std::uint32_t listed_;
  ArrayTour tour_;
  std::vector<bool> queued_;
  std::vector<Point> pushed_;
  bool marked_ = false;
  std::vector<ArrayTour::Way> turned_;
};

struct PolishOptions {
  /// Kicks of iterated local search for each point, after the first local optimum; 0: none. `seconds` override it.
  double kicks_per_point = 50;
  std::uint64_t seed = 1;
  /// If above 0, kicks for that long, and the tour depends on the machine's speed.
  double seconds = 0;
  Progress progress = {};  // of the kicks, unless `seconds` bound them
};

/// Starts from a local optimum. Two neighbouring parts of up to 50 points change places and the search repairs the tour
/// around them; if the tour is then longer, all is undone. The places follow the tour around in random steps, so that
/// what the last kick touched is still in the cache.
template <typename Distances>
void iterate(LocalSearch<Distances>& search, const PolishOptions& options) {
  const std::uint32_t count = search.tour().size(), longest = std::min(50u, (count - 2) / 3);
  const auto start = std::chrono::steady_clock::now();
  const auto out_of_time = [&] {
    return options.seconds > 0 &&
           std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() > options.seconds;
  };
  const std::uint64_t most =
      options.seconds > 0 ? ~std::uint64_t{0} : static_cast<std::uint64_t>(options.kicks_per_point * count);
  Random random(options.seed);
  std::uint32_t place = 0;
  for (std::uint64_t kick = 0; kick < most && (kick % 256 != 0 || !out_of_time()); ++kick) {
    if (options.progress && options.seconds <= 0 && kick % 4096 == 0) options.progress(kick, most);
    place = (place + random.below(20)) % count;
    const std::uint32_t one = 1 + random.below(longest), two = 1 + random.below(longest);
    search.mark();
    const std::int64_t saved = search.kick(place, one, two);
    if (saved + search.run() < 0) search.undo();
  }
}

}  // namespace vismat
