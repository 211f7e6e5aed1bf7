// ALGORITHM. A 1-tree is a spanning tree of the columns and two edges more from the zero point; every closed
// tour is one, so the cheapest 1-tree costs no more than the cheapest tour. Adding p_i to every edge at i
// adds 2 sum(p) to every tour and changes which 1-tree is cheapest; the best bound over all p is Held and
// Karp's. We climb along the subgradient, degree - 2, with 0.3 of the last one mixed in, by steps that shrink
// when nothing is gained.
//
// PROOF of the integers. Distances are scaled by `scale` and potentials are integers of that scale, so a
// 1-tree's weight W is exact and every tour T satisfies scale * length(T) >= W - 2 sum(p). Length is twice
// the runs, hence runs >= (W - 2 sum(p)) / (2 scale), rounded up, whatever the potentials: the floating-point
// steps that led to them do not matter.
//
// NOT sound, though tempting: the spanning tree of a graph of nearest neighbours only (a tree of the whole
// graph may be cheaper elsewhere once potentials are added), and sums of bounds over blocks of columns (edges
// between blocks may replace edges within).
#include "layout/held_karp.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace vismat {
namespace {

constexpr std::int64_t scale = 1024;

// Key holds scale * distance and two potentials: 2^26 + 2^29 at most where Distance has 16 bits.
template <typename Distance, typename Key>
class OneTrees {
 public:
  OneTrees(const ColumnPoints& points, unsigned threads)
      : n_(points.size()), distance_(std::size_t{n_} * n_), to_zero_(n_) {
    parallel_for(n_, threads, [&](std::uint64_t i) {
      const auto a = static_cast<std::uint32_t>(i);
      to_zero_[a] = points.distance(a, points.zero());
      for (std::uint32_t b = 0; b < a; ++b) {
        distance_[std::size_t{a} * n_ + b] = distance_[std::size_t{b} * n_ + a] =
            static_cast<Distance>(points.distance(a, b));
      }
    });
  }

  // The cheapest 1-tree's weight under the potentials; fills in the degrees. Point n_ is the zero point.
  std::int64_t cheapest(const std::vector<std::int32_t>& potential, std::vector<std::int32_t>& degree) {
    degree.assign(n_ + 1, 0);
    std::int64_t weight = 0;
    // Prim: the points outside the tree are kept together at the front of `outside_`, with their cheapest
    // edge to it.
    outside_.resize(n_);
    key_.assign(n_, std::numeric_limits<Key>::max());
    from_.assign(n_, 0);
    for (std::uint32_t i = 0; i < n_; ++i) outside_[i] = i;
    std::uint32_t last = 0, left = n_;
    outside_[0] = outside_[--left];
    key_[0] = key_[left];
    while (left > 0) {
      const Distance* row = distance_.data() + std::size_t{last} * n_;
      const Key base = potential[last];
      std::uint32_t best = 0;
      Key best_key = std::numeric_limits<Key>::max();
      for (std::uint32_t i = 0; i < left; ++i) {
        const std::uint32_t p = outside_[i];
        const Key k = static_cast<Key>(row[p]) * static_cast<Key>(scale) + base + potential[p];
        if (k < key_[i]) {
          key_[i] = k;
          from_[i] = last;
        }
        if (key_[i] < best_key) {
          best_key = key_[i];
          best = i;
        }
      }
      weight += best_key;
      ++degree[from_[best]];
      last = outside_[best];
      ++degree[last];
      --left;
      outside_[best] = outside_[left];
      key_[best] = key_[left];
      from_[best] = from_[left];
    }
    std::int64_t first = std::numeric_limits<std::int64_t>::max(), second = first;
    std::uint32_t first_at = 0, second_at = 0;
    for (std::uint32_t p = 0; p < n_; ++p) {
      const std::int64_t k = std::int64_t{to_zero_[p]} * scale + potential[p] + potential[n_];
      if (k < first) {
        second = first;
        second_at = first_at;
        first = k;
        first_at = p;
      } else if (k < second) {
        second = k;
        second_at = p;
      }
    }
    ++degree[first_at];
    ++degree[second_at];
    degree[n_] = 2;
    return weight + first + second;
  }

 private:
  std::uint32_t n_;
  std::vector<Distance> distance_;
  std::vector<std::uint32_t> to_zero_;
  std::vector<std::uint32_t> outside_, from_;
  std::vector<Key> key_;
};

template <typename Distance, typename Key>
HeldKarpBound ascend(const ColumnPoints& points, const HeldKarpOptions& options) {
  const std::uint32_t n = points.size();
  if (n < 2) return {n == 0 ? 0 : points.distance(0, points.zero()), {}};  // no 1-tree, and nothing to order
  OneTrees<Distance, Key> trees(points, options.threads);
  std::vector<std::int32_t> potential(n + 1, 0), degree, before(n + 1, 2);
  HeldKarpBound bound;
  double agility = 1, best_length = 0;
  std::uint32_t since_gain = 0;
  std::vector<std::int32_t> best_potential = potential;
  for (std::uint32_t step = 0; step < options.steps; ++step) {
    std::int64_t twice_sum = 0;
    for (const std::int32_t p : potential) twice_sum += 2 * std::int64_t{p};
    const std::int64_t length = trees.cheapest(potential, degree) - twice_sum;  // scaled
    const std::int64_t runs = length <= 0 ? 0 : (length + 2 * scale - 1) / (2 * scale);
    bound.runs = std::max(bound.runs, static_cast<std::uint64_t>(runs));
    bound.history.push_back(bound.runs);
    if (static_cast<double>(length) > best_length) {
      best_length = static_cast<double>(length);
      best_potential = potential;
      since_gain = 0;
    } else if (++since_gain >= 8) {
      agility *= .7;
      since_gain = 0;
      potential = best_potential;
    }
    double norm = 0;
    for (std::uint32_t i = 0; i <= n; ++i) norm += static_cast<double>(degree[i] - 2) * (degree[i] - 2);
    if (norm == 0) break;  // the 1-tree is a tour: nothing is shorter
    const double target =
        options.known_runs > 0 ? 2. * static_cast<double>(options.known_runs * scale) : best_length * 1.05;
    const double stride = agility * std::max(target - static_cast<double>(length), best_length * 1e-4) / norm;
    for (std::uint32_t i = 0; i <= n; ++i) {
      const double change = stride * (.7 * (degree[i] - 2) + .3 * (before[i] - 2));
      const double moved = potential[i] + change;
      potential[i] = static_cast<std::int32_t>(std::clamp(std::nearbyint(moved), -2.6e8, 2.6e8));
    }
    before = degree;
  }
  return bound;
}

}  // namespace

HeldKarpBound held_karp_bound(const ColumnPoints& points, const HeldKarpOptions& options) {
  if (points.rows() <= 0xffff) return ascend<std::uint16_t, std::int32_t>(points, options);
  return ascend<std::uint32_t, std::int64_t>(points, options);
}

}  // namespace vismat
