#include "matrix/points/column_points.h"

#include <algorithm>
#include <array>

namespace vismat {

NeighbourLists exact_neighbours(const ColumnPoints& points, std::uint32_t k, unsigned threads,
                                const Progress& progress) {
  constexpr std::uint32_t strip =
      8;  // points held against all others while these pass through the cache once
  const std::uint32_t count = points.size() + 1;
  k = std::min(k, count - 1);
  NeighbourLists lists{k, std::vector<std::uint32_t>(std::size_t{count} * k),
                       std::vector<std::uint32_t>(std::size_t{count} * k)};
  if (k == 0) return lists;
  const auto list_strip = [&](std::uint64_t s) {
    const auto first = static_cast<std::uint32_t>(s * strip), end = std::min(count, first + strip);
    std::array<std::vector<std::uint64_t>, strip> nearest;  // keys: distance, then point
    std::array<std::uint64_t, strip> limit;                 // keys from here on are not among the k nearest
    limit.fill(~std::uint64_t{0});
    const auto keep_nearest = [&](std::uint32_t p) {
      auto& keys = nearest[p - first];
      std::nth_element(keys.begin(), keys.begin() + k - 1, keys.end());
      keys.resize(k);
      limit[p - first] = keys[k - 1];
    };
    for (std::uint32_t q = 0; q < count; ++q) {
      for (std::uint32_t p = first; p < end; ++p) {
        const std::uint64_t key = std::uint64_t{points.distance(p, q)} << 32 | q;
        if (key >= limit[p - first] || p == q) continue;
        nearest[p - first].push_back(key);
        if (nearest[p - first].size() == 4 * std::size_t{k}) keep_nearest(p);
      }
    }
    for (std::uint32_t p = first; p < end; ++p) {
      keep_nearest(p);
      std::sort(nearest[p - first].begin(), nearest[p - first].end());
      for (std::uint32_t n = 0; n < k; ++n) {
        lists.distances[std::size_t{p} * k + n] = static_cast<std::uint32_t>(nearest[p - first][n] >> 32);
        lists.ids[std::size_t{p} * k + n] = static_cast<std::uint32_t>(nearest[p - first][n]);
      }
    }
  };
  parallel_for((count + strip - 1) / strip, threads, list_strip, progress);
  return lists;
}

}  // namespace vismat
