#include "runtime/level_walk.h"

#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <queue>
#include <stdexcept>
#include <utility>

#include "matrix/base/random.h"

namespace vismat {

VisibilityMatrix passages_of(const Level& level) {
  std::vector<std::vector<std::uint32_t>> to(level.cells.shape().rows);
  for (std::uint32_t a = 0; a < to.size(); ++a) {
    for (const std::uint32_t b : level.cell_neighbours.row(a)) {
      if (level.cells.contains(a, b) && level.cells.contains(b, a)) to[a].push_back(b);
    }
  }
  return VisibilityMatrix::from_rows(to, level.cells.shape().rows);
}

std::vector<std::uint32_t> largest_part(const VisibilityMatrix& passages) {
  std::vector<bool> reached(passages.shape().rows, false);
  std::vector<std::uint32_t> largest;
  for (std::uint32_t start = 0; start < reached.size(); ++start) {
    if (reached[start]) continue;
    std::vector<std::uint32_t> part = {start};
    reached[start] = true;
    for (std::size_t i = 0; i < part.size(); ++i) {
      for (const std::uint32_t next : passages.row(part[i])) {
        if (reached[next]) continue;
        reached[next] = true;
        part.push_back(next);
      }
    }
    if (part.size() > largest.size()) largest = std::move(part);
  }
  return largest;
}

std::vector<std::uint32_t> shortest_way(const VisibilityMatrix& passages, std::span<const Box> cells,
                                        std::uint32_t from, std::uint32_t goal) {
  const auto centre = [&](std::uint32_t cell) {
    const auto [x, y, z] = centre_of(cells[cell]);
    return glm::vec3(x, y, z);
  };
  std::vector<float> length(cells.size(), INFINITY);
  std::vector<std::uint32_t> next(cells.size(), goal);
  using Reached = std::pair<float, std::uint32_t>;
  std::priority_queue<Reached, std::vector<Reached>, std::greater<>> queue;
  length[goal] = 0;
  queue.emplace(0.f, goal);
  while (!queue.empty() && queue.top().second != from) {  // from the goal, so that `next` leads to it
    const auto [so_far, cell] = queue.top();
    queue.pop();
    if (so_far > length[cell]) continue;
    for (const std::uint32_t other : passages.row(cell)) {
      const float longer = so_far + glm::distance(centre(cell), centre(other));
      if (longer >= length[other]) continue;
      length[other] = longer;
      next[other] = cell;
      queue.emplace(longer, other);
    }
  }
  std::vector<std::uint32_t> way;
  for (std::uint32_t at = from; at != goal;) way.push_back(at = next[at]);
  return way;
}

std::vector<std::uint32_t> walk_cells(const VisibilityMatrix& passages, std::span<const Box> cells,
                                      std::uint32_t steps, std::uint64_t seed) {
  const auto part = largest_part(passages);
  if (part.size() < 2) throw std::invalid_argument("no passage leads from any cell to another");
  Random random(seed);
  std::vector<std::uint32_t> walk = {part[random.below(static_cast<std::uint32_t>(part.size()))]};
  while (walk.size() <= steps) {
    const std::uint32_t goal = part[random.below(static_cast<std::uint32_t>(part.size()))];
    const auto further = shortest_way(passages, cells, walk.back(), goal);
    walk.insert(walk.end(), further.begin(), further.end());
  }
  walk.resize(std::size_t{steps} + 1);
  return walk;
}

}  // namespace vismat
