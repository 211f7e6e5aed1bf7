// Tours of greedy edges: shortest first, as long as they make no branch and no cycle [Bentley 1992].
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "layout/points/column_points.h"
#include "matrix/base/union_find.h"

namespace vismat {

struct Edge {
  std::uint32_t distance, a, b;  // a < b
  auto operator<=>(const Edge&) const = default;
};

/// The edges of lists, some of them twice; 0xffffffff for a distance ends a list.
std::vector<Edge> edges_of(const NeighbourLists& lists);

/// Ways that grow together until one through all points is left: at first each point is one.
class Fragments {
 public:
  explicit Fragments(std::uint32_t size);
  /// Sorts the edges; takes those that join the ends of two different fragments.
  void join_shortest_first(std::vector<Edge>& edges);
  /// Points with less than two neighbours, ascending.
  std::vector<std::uint32_t> ends() const;
  bool same(std::uint32_t a, std::uint32_t b) { return components_.find(a) == components_.find(b); }
  /// Once one is left: its points from one end to the other.
  std::vector<std::uint32_t> walk() const;

  /// Joins all of them, by the measure of each pair of ends. O(ends^2).
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
