// Disjoint sets of points that can be joined (union-find).
#pragma once
#include <algorithm>
#include <cstdint>
#include <numeric>
#include <vector>

namespace vismat {

/// The points [0, size), each of which is a set of its own at first. A set is named by one of its points, its root.
/// Path halving keeps find() short: O(log size), amortised.
class UnionFind {
 public:
  explicit UnionFind(std::uint32_t size) : parent_(size) { std::iota(parent_.begin(), parent_.end(), 0u); }
  /// The root of the point's set.
  std::uint32_t find(std::uint32_t p) {
    while (parent_[p] != p) p = parent_[p] = parent_[parent_[p]];
    return p;
  }
  /// Joins two sets, given by their roots; `parent` is the root of the result.
  void join(std::uint32_t child, std::uint32_t parent) { parent_[child] = parent; }
  /// Joins the sets of two points. The lower root stays: if all joins are made in this way, a set's root is its lowest
  /// point.
  void join_sets(std::uint32_t a, std::uint32_t b) {
    const auto [least, other] = std::minmax({find(a), find(b)});
    join(other, least);
  }

 private:
  std::vector<std::uint32_t> parent_;
};

}  // namespace vismat
