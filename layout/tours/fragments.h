// Tours by greedy edges: the shortest edges first, as long as they make no branch and no cycle [Bentley 1992].
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "matrix/base/union_find.h"
#include "matrix/points/column_points.h"

namespace vismat {

struct Edge {
  std::uint32_t distance, a, b;  // a < b
  auto operator<=>(const Edge&) const = default;
};

/// The edges of the lists, some of them twice. A distance of 0xffffffff ends a list.
std::vector<Edge> edges_of(const NeighbourLists& lists);

/// Paths that are joined until one path through all points is left. At first each point is a path.
class Fragments {
 public:
  explicit Fragments(std::uint32_t size);
  /// Sorts the edges and takes those that join the ends of two different fragments.
  void join_shortest_first(std::vector<Edge>& edges);
  /// The points with fewer than two neighbours, ascending.
  std::vector<std::uint32_t> ends() const;
  bool same(std::uint32_t a, std::uint32_t b) { return components_.find(a) == components_.find(b); }
  /// The points of the last fragment from one end to the other, once only one is left.
  std::vector<std::uint32_t> walk() const;

  /// Joins all fragments, by the measure of each pair of ends. O(ends^2).
  template <typename Measure>
  std::vector<std::uint32_t> join_all(const Measure& measure) {
    const std::vector<std::uint32_t> left = ends();
    std::vector<Edge> edges;
    for (std::size_t j = 0; j < left.size(); ++j) {
      for (std::size_t i = 0; i < j; ++i) {
        if (!same(left[i], left[j])) edges.push_back({measure(left[i], left[j]), left[i], left[j]});
      }
    }
    join_shortest_first(edges);
    return walk();
  }

 private:
  bool is_end(std::uint32_t p) const;
  UnionFind components_;
  std::vector<std::array<std::uint32_t, 2>> links_;
};

}  // namespace vismat
