// Which points hang together.
#pragma once
#include <cstdint>
#include <numeric>
#include <vector>

namespace vismat {

/// Union-find with path halving: at first each point is a component of its own.
class UnionFind {
 public:
  explicit UnionFind(std::uint32_t size) : root_(size) { std::iota(root_.begin(), root_.end(), 0u); }
  std::uint32_t find(std::uint32_t p) {
    while (root_[p] != p) p = root_[p] = root_[root_[p]];
    return p;
  }
  /// Both are roots; `parent` stays one.
  void join(std::uint32_t child, std::uint32_t parent) { root_[child] = parent; }

 private:
  std::vector<std::uint32_t> root_;
};

}  // namespace vismat
