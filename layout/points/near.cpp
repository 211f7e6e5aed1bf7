// ALGORITHM. Near points. As long as all pairs can be compared, they are, which finds every near point: from an
// inverted index where the points are sparse, from bits where they are dense (point_comparison.h). Columns of s times as many rows have about the root of s times as many ones where they are the rims of
// regions, as on the power plant; the index then grows with the square of the sides, bits with the cube. Beyond that,
// min-hash gives candidates, sketches choose among them, and the lists are those of exact distances (sketch.cpp).
#include "layout/points/near.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "layout/points/point_comparison.h"
#include "layout/points/sketch.h"

namespace vismat {
namespace {

NeighbourLists compare_all(const SparsePoints& points, std::uint32_t wanted,
                           const PointComparison& comparison, const Progress& progress, unsigned threads) {
  const std::size_t count = points.size();
  NeighbourLists lists{wanted, std::vector<std::uint32_t>(count * wanted),
                       std::vector<std::uint32_t>(count * wanted)};
  const auto take = [&](std::uint32_t p, std::span<const std::uint32_t> distances) {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> nearest;  // (distance, point), the farthest first
    nearest.reserve(wanted + std::size_t{1});
    for (std::uint32_t q = 0; q < count; ++q) {
      if (nearest.size() == wanted && distances[q] >= nearest.front().first) continue;
      if (q == p) continue;
      nearest.emplace_back(distances[q], q);
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

}  // namespace

NearPoints near_points(const SparsePoints& points, const NearOptions& options, unsigned threads) {
  const std::uint32_t wanted = points.size() == 0 ? 0 : std::min(options.neighbours, points.size() - 1);
  if (wanted == 0) return {};
  if (all_pairs_cost(points).least() <= 1e9 * options.exact_seconds) {
    return {compare_all(points, wanted, PointComparison(points),
                        begin_stage(options.stages, "distances of all pairs"), threads)};
  }
  const NearbyOptions nearby{.neighbours = wanted, .seed = options.seed, .stages = options.stages};
  const ColumnSketches sketches(points, 0, threads);
  return {nearby_points(points, sketches, nearby, threads), false};
}

}  // namespace vismat
