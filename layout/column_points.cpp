#include "layout/column_points.h"

#include <algorithm>
#include <utility>

namespace vismat {

NeighbourLists exact_neighbours(const ColumnPoints& points, std::uint32_t k, unsigned threads) {
  const std::uint32_t count = points.size() + 1;
  k = std::min(k, count - 1);
  NeighbourLists lists{k, std::vector<std::uint32_t>(std::size_t{count} * k),
                       std::vector<std::uint32_t>(std::size_t{count} * k)};
  parallel_for(count, threads, [&](std::uint64_t i) {
    std::vector<std::pair<std::uint32_t, std::uint32_t>>
        nearest;  // (distance, id), a heap whose top is the worst
    for (std::uint32_t j = 0; j < count; ++j) {
      if (j == i) continue;
      const std::uint32_t worst = nearest.size() < k ? 0xffffffff : nearest.front().first;
      const std::uint32_t d = points.distance(static_cast<std::uint32_t>(i), j, worst);
      if (nearest.size() == k && std::pair(d, j) >= nearest.front()) continue;
      if (nearest.size() == k) {
        std::pop_heap(nearest.begin(), nearest.end());
        nearest.pop_back();
      }
      nearest.emplace_back(d, j);
      std::push_heap(nearest.begin(), nearest.end());
    }
    std::sort_heap(nearest.begin(), nearest.end());
    for (std::uint32_t n = 0; n < k; ++n) {
      lists.distances[i * k + n] = nearest[n].first;
      lists.ids[i * k + n] = nearest[n].second;
    }
  });
  return lists;
}

}  // namespace vismat
