// ALGORITHM. Near points. As long as all pairs can be compared, they are, which finds every near point: from an
// inverted index where the points are sparse, from bits where they are dense (point_comparison.h). Columns of s times as many rows have about the root of s times as many ones where they are the rims of
// regions, as on the power plant; the index then grows with the square of the sides, bits with the cube. Beyond that,
// min-hash gives candidates, sketches choose among them, and the lists are those of exact distances (sketch.cpp).
#include "matrix/points/near.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "matrix/points/point_comparison.h"
#include "matrix/points/sketch.h"

namespace vismat {
namespace {

NeighbourLists compare_all(const SparsePoints& points, std::uint32_t wanted, std::uint32_t lacked,
                           const PointComparison& comparison, const Progress& progress, unsigned threads) {
  const std::size_t count = points.size();
  NeighbourLists lists{wanted, std::vector<std::uint32_t>(count * wanted),
                       std::vector<std::uint32_t>(count * wanted)};
  std::vector<std::uint32_t> weights;
  for (std::uint32_t p = 0; p < count; ++p) weights.push_back(points.weight(p));
  const auto take = [&](std::uint32_t p, std::span<const std::uint32_t> differences) {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> nearest;  // (distance, point), the farthest first
    nearest.reserve(wanted + std::size_t{1});
    for (std::uint32_t q = 0; q < count; ++q) {
      const std::uint32_t distance =
          lacked == 1 ? differences[q] : distance_with(lacked, differences[q], weights[p], weights[q]);
      if (nearest.size() == wanted && distance >= nearest.front().first) continue;
      if (q == p) continue;
      nearest.emplace_back(distance, q);
      std::push_heap(nearest.begin(), nearest.end());
      if (nearest.size() <= wanted) continue;
      std::pop_heap(nearest.begin(), nearest.end());
      nearest.pop_back();
    }
    std::sort_heap(nearest.begin(), nearest.end());
    for (std::size_t n = 0; n < nearest.size(); ++n) {
      lists.distances[p * std::size_t{wanted} + n] = nearest[n].first;
      lists.ids[p * std::size_t{wanted} + n] = nearest[n].second;
    }
  };
  comparison.each_row(take, threads, progress);
  return lists;
}

// The zero point is as far from each point as that has ones.
NeighbourLists with_zero(const NeighbourLists& lists, const SparsePoints& points, std::uint32_t wanted,
                         std::uint32_t lacked) {
  const std::uint32_t count = points.size();
  NeighbourLists whole{wanted, {}, {}};
  std::vector<std::pair<std::uint32_t, std::uint32_t>> near;
  const auto append = [&](std::uint32_t distance, std::uint32_t point) {
    whole.distances.push_back(distance);
    whole.ids.push_back(point);
  };
  for (std::uint32_t p = 0; p < count; ++p) {
    near = {{lacked * points.weight(p), points.zero()}};
    for (std::size_t n = 0; n < lists.per_point; ++n) {
      const std::size_t at = p * std::size_t{lists.per_point} + n;
      near.emplace_back(lists.distances[at], lists.ids[at]);
    }
    std::ranges::inplace_merge(near, near.begin() + 1);
    near.resize(wanted);
    for (const auto& [distance, q] : near) append(distance, q);
  }
  near.clear();
  for (std::uint32_t p = 0; p < count; ++p) near.emplace_back(points.weight(p), p);
  std::ranges::partial_sort(near, near.begin() + wanted);
  for (std::uint32_t n = 0; n < wanted; ++n) append(near[n].first, near[n].second);
  return whole;
}

}  // namespace

NearPoints near_points(const SparsePoints& points, const NearOptions& options, unsigned threads) {
  const std::uint32_t count = points.size(),
                      wanted = std::min(options.neighbours, count == 0 ? 0 : count - 1);
  NearPoints near;
  near.exact = wanted == 0 || all_pairs_cost(points).least() <= 1e9 * options.exact_seconds;
  if (wanted > 0 && near.exact) {
    near.lists = compare_all(points, wanted, options.lacked, PointComparison(points),
                             begin_stage(options.stages, "distances of all pairs"), threads);
  } else if (wanted > 0) {
    near.lists = nearby_points(
        points, ColumnSketches(points, 0, threads),
        {.neighbours = wanted, .lacked = options.lacked, .seed = options.seed, .stages = options.stages},
        threads);
  }
  if (options.zero)
    near.lists = with_zero(near.lists, points, std::min(options.neighbours, count), options.lacked);
  return near;
}

}  // namespace vismat
