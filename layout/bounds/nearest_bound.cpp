// ALGORITHM AND PROOFS. The two-nearest lower bound. The distance of columns i and j is |i \ j| + |j \ i|, the ones
// that only one of them has.
//
// Certificate. Divide the rows into groups, in any way. The numbers of ones that two columns have in a group differ at
// most by their distance there. So the sum of the differences of these counts is a lower bound of the distance, and it
// remains one if counts are cut off at 255. It holds for blocks of columns as well, with the gap between the least and
// greatest counts of each. Points are taken in blocks along a good order, so that a block's counts are similar. The
// other blocks are visited nearest first, by that bound, until the bound is no less than the last distance of every
// list in the block: the remaining points are no nearer. If the work is used up before that, the next block's bound is
// the threshold of all. Within a visited block, a point is first compared with the block's counts, then with each
// point's counts, then by sketches, then exactly. Groups follow the rows' first appearance along the order: rows of one
// region are together, whatever their numbers. Tried and found worse: prefix filtering (rarest rows against an inverted
// index), exact too, but 10 s against 1 s at 25,000 columns and growing with the square.
//
// Two-nearest bound. A closed tour has two edges at each point, and its length is half the sum of them. The two are at
// least as long as the two shortest that exist, and unlisted ones are at least as long as the threshold. The number of
// runs is half the length.
#include "layout/bounds/nearest_bound.h"

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "matrix/base/parallel.h"

namespace vismat {
namespace {

constexpr std::uint32_t none = 0xffffffff;

using Neighbour = std::pair<std::uint32_t, std::uint32_t>;  // (distance, point)

constexpr std::size_t groups = 512;
struct alignas(64) Counts : std::array<std::uint8_t, groups> {};

// Between the counts of two blocks, or of two points where low and high are one; some number not below
// `limit` as soon as it is known not to be.
std::uint32_t gap(const Counts& low_a, const Counts& high_a, const Counts& low_b, const Counts& high_b,
                  std::uint32_t limit) {
  std::uint32_t sum = 0;
  for (std::size_t g = 0; g < groups && sum < limit;) {
    const std::size_t end = g + 64;
#if defined(__SSE2__)
    const auto load = [](const std::uint8_t& at) {
      return _mm_load_si128(reinterpret_cast<const __m128i*>(&at));
    };
    __m128i four = _mm_setzero_si128();
    for (; g < end; g += 16) {
      const __m128i above = _mm_subs_epu8(load(low_a[g]), load(high_b[g]));
      const __m128i below = _mm_subs_epu8(load(low_b[g]), load(high_a[g]));  // one of the two is 0
      four = _mm_add_epi64(four, _mm_sad_epu8(_mm_or_si128(above, below), _mm_setzero_si128()));
    }
    sum += static_cast<std::uint32_t>(_mm_cvtsi128_si32(four) + _mm_cvtsi128_si32(_mm_srli_si128(four, 8)));
#else
    for (; g < end; ++g) {
      if (low_a[g] > high_b[g]) sum += low_a[g] - high_b[g];
      if (low_b[g] > high_a[g]) sum += low_b[g] - high_a[g];
    }
#endif
  }
  return sum;
}

class Certifier {
 public:
  Certifier(const SparsePoints& points, const ColumnSketches& sketches, std::span<const std::uint32_t> visits,
            const CertifyOptions& options, unsigned threads)
      : points_(points),
        sketches_(sketches),
        visits_(visits),
        options_(options),
        counts_(visits.size()),
        blocks_((visits.size() + options.block - 1) / options.block) {
    std::vector<std::uint32_t> appearance(points.rows(), none);
    std::uint32_t seen = 0;
    for (const std::uint32_t p : visits) {
      for (const std::uint32_t row : points.ones(p)) {
        if (appearance[row] == none) appearance[row] = seen++;
      }
    }
    parallel_for(blocks_.size(), threads, [&](std::uint64_t b) {
      Block& block = blocks_[b];
      block.low.fill(255);
      block.high.fill(0);
      for (std::size_t place = first(b); place < first(b + 1); ++place) {
        Counts& counts = counts_[place];
        counts.fill(0);
        for (const std::uint32_t row : points.ones(visits[place])) {
          std::uint8_t& count = counts[std::uint64_t{appearance[row]} * groups / seen];
          if (count < 255) ++count;
        }
        for (std::size_t g = 0; g < groups; ++g) {
          block.low[g] = std::min(block.low[g], counts[g]);
          block.high[g] = std::max(block.high[g], counts[g]);
        }
      }
    });
  }
  std::size_t block_count() const { return blocks_.size(); }

  // Completes the lists of a block's points and sets their thresholds; touches nothing of other points.
  void complete(std::size_t b, CertifiedNeighbours& result) const {
    std::vector<Around> around;
    for (std::size_t place = first(b); place < first(b + 1); ++place)
      around.emplace_back(place, visits_[place], result);
    const auto farthest = [&] {
      std::uint32_t distance = 0;
      for (const Around& a : around) distance = std::max(distance, a.limit());
      return distance;
    };
    const std::uint32_t reach = farthest();
    std::vector<std::pair<std::uint32_t, std::uint32_t>> met;  // (gap, block)
    for (std::uint32_t other = 0; other < blocks_.size(); ++other) {
      const std::uint32_t apart =
          gap(blocks_[b].low, blocks_[b].high, blocks_[other].low, blocks_[other].high, reach);
      if (apart < reach) met.emplace_back(apart, other);
    }
    std::sort(met.begin(), met.end());
    std::uint64_t work = options_.work * around.size();
    std::uint32_t certain = none;
    for (const auto& [apart, other] : met) {
      if (apart >= farthest()) break;
      if (work < options_.block * around.size()) {
        certain = apart;
        break;
      }
      for (Around& a : around) {
        const Counts& own = counts_[a.place];
        if (apart >= a.limit() ||
            gap(own, own, blocks_[other].low, blocks_[other].high, a.limit()) >= a.limit())
          continue;
        work -= first(other + 1) - first(other);
        for (std::size_t place = first(other); place < first(other + 1); ++place) {
          if (gap(own, own, counts_[place], counts_[place], a.limit()) < a.limit()) look(a, visits_[place]);
        }
      }
    }
    for (const Around& a : around) a.put(std::min(certain, a.limit()), result);
  }

 private:
  struct Block {
    Counts low, high;
  };
  // A point with its list as it grows.
  struct Around {
    Around(std::size_t at, std::uint32_t number, const CertifiedNeighbours& result)
        : place(at), point(number), most(result.lists.per_point) {
      const std::size_t base = std::size_t{point} * most;
      for (std::size_t i = base; i < base + most && result.lists.ids[i] != none; ++i)
        list.emplace_back(result.lists.distances[i], result.lists.ids[i]);
    }
    std::uint32_t limit() const { return list.size() < most ? none : list.back().first; }
    void put(std::uint32_t threshold, CertifiedNeighbours& result) const {
      result.threshold[point] = threshold;
      for (std::size_t i = 0; i < list.size(); ++i) {
        result.lists.distances[std::size_t{point} * most + i] = list[i].first;
        result.lists.ids[std::size_t{point} * most + i] = list[i].second;
      }
    }
    std::size_t place;
    std::uint32_t point, most;
    std::vector<Neighbour> list;
  };

  void look(Around& a, std::uint32_t q) const {
    if (q == a.point || sketches_.lower_bound(a.point, q, a.limit()) >= a.limit()) return;
    if (std::any_of(a.list.begin(), a.list.end(), [&](const Neighbour& n) { return n.second == q; })) return;
    const Neighbour found(points_.distance(a.point, q), q);
    if (found.first >= a.limit()) return;
    a.list.insert(std::lower_bound(a.list.begin(), a.list.end(), found), found);
    if (a.list.size() > a.most) a.list.pop_back();
  }
  std::size_t first(std::size_t block) const { return std::min(visits_.size(), block * options_.block); }

  const SparsePoints& points_;
  const ColumnSketches& sketches_;
  std::span<const std::uint32_t> visits_;
  CertifyOptions options_;
  std::vector<Counts> counts_;  // of the point at a place in the order
  std::vector<Block> blocks_;
};

// The two nearest of each point among those a few places away in the order.
NeighbourLists nearest_in_order(const SparsePoints& points, const ColumnSketches& sketches,
                                std::span<const std::uint32_t> visits, unsigned threads) {
  constexpr std::size_t window = 4, most = 2;
  const std::size_t count = visits.size();
  NeighbourLists lists{most, std::vector<std::uint32_t>(count * most, none),
                       std::vector<std::uint32_t>(count * most, none)};
  parallel_for((count + 255) / 256, threads, [&](std::uint64_t piece) {
    for (std::size_t place = piece * 256; place < std::min(count, (piece + 1) * 256); ++place) {
      const std::uint32_t p = visits[place];
      std::array<Neighbour, most> nearest = {Neighbour{none, none}, Neighbour{none, none}};
      for (std::size_t i = place - std::min(place, window); i < std::min(count, place + window + 1); ++i) {
        if (i == place || sketches.lower_bound(p, visits[i], nearest[1].first) >= nearest[1].first) continue;
        nearest[1] = std::min(nearest[1], Neighbour{points.distance(p, visits[i]), visits[i]});
        if (nearest[1] < nearest[0]) std::swap(nearest[0], nearest[1]);
      }
      for (std::size_t i = 0; i < most; ++i) {
        lists.distances[p * most + i] = nearest[i].first;
        lists.ids[p * most + i] = nearest[i].second;
      }
    }
  });
  return lists;
}

}  // namespace

CertifiedNeighbours certify_neighbours(const SparsePoints& points, const ColumnSketches& sketches,
                                       const NeighbourLists& lists, std::span<const std::uint32_t> visits,
                                       const CertifyOptions& options, unsigned threads) {
  if (options.block == 0) throw std::invalid_argument("blocks hold at least 1 point");
  CertifiedNeighbours result{lists, std::vector<std::uint32_t>(points.size(), 0)};
  if (lists.per_point == 0) return result;
  const Certifier certifier(points, sketches, visits, options, threads);
  parallel_for(
      certifier.block_count(), threads, [&](std::uint64_t b) { certifier.complete(b, result); },
      begin_stage(options.stages, "bound by nearest columns"));
  return result;
}

std::uint64_t two_nearest_bound(const SparsePoints& points, std::span<const std::uint32_t> visits,
                                const CertifyOptions& options, unsigned threads) {
  const ColumnSketches sketches(points, 0, threads);
  const NeighbourLists lists = nearest_in_order(points, sketches, visits, threads);
  return two_nearest_bound(points, certify_neighbours(points, sketches, lists, visits, options, threads));
}

std::uint64_t two_nearest_bound(const SparsePoints& points, const CertifiedNeighbours& neighbours) {
  const std::uint32_t n = points.size(), per_point = neighbours.lists.per_point;
  if (n < 2) return n == 0 ? 0 : points.weight(0);
  std::vector<std::uint32_t> first(n + 1, none), second(n + 1, none);
  const auto offer = [&](std::uint32_t p, std::uint32_t distance) {
    if (distance < first[p])
      second[p] = std::exchange(first[p], distance);
    else
      second[p] = std::min(second[p], distance);
  };
  for (std::uint32_t p = 0; p < n; ++p) {
    for (int twice = 0; twice < 2; ++twice) offer(p, neighbours.threshold[p]);
    offer(p, points.weight(p));
    offer(n, points.weight(p));
    // From both sides an edge may be offered twice; that only lowers the bound.
    for (std::size_t i = std::size_t{p} * per_point; i < (std::size_t{p} + 1) * per_point; ++i) {
      if (neighbours.lists.ids[i] != none) offer(p, neighbours.lists.distances[i]);
    }
  }
  // What q lists and p does not is missed above: p's own list is full of nearer ones, or the edge is below
  // p's threshold.
  for (std::uint32_t p = 0; p < n; ++p) {
    for (std::size_t i = std::size_t{p} * per_point; i < (std::size_t{p} + 1) * per_point; ++i) {
      const std::uint32_t q = neighbours.lists.ids[i];
      if (q == none) continue;
      const auto begin =
          neighbours.lists.ids.begin() + static_cast<std::ptrdiff_t>(std::size_t{q} * per_point);
      if (std::find(begin, begin + per_point, p) == begin + per_point)
        offer(q, neighbours.lists.distances[i]);
    }
  }
  std::uint64_t sum = 0;
  for (std::uint32_t p = 0; p <= n; ++p) sum += std::uint64_t{first[p]} + second[p];
  return (sum + 3) / 4;
}

}  // namespace vismat
