#include "layout/orders/lexicographic_order.h"

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

namespace vismat {

Permutation lexicographic_order(const VisibilityMatrix& matrix) {
  const VisibilityMatrix columns = transpose(matrix);
  std::vector<std::uint32_t> order(columns.shape().rows);
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    const auto x = columns.row(a), y = columns.row(b);
    const auto [i, j] = std::mismatch(x.begin(), x.end(), y.begin(), y.end());
    return i != x.end() && (j == y.end() || *i < *j);  // at the first row where they differ, a has the one
  });
  return Permutation::from_old_of_new(std::move(order));
}

}  // namespace vismat
