// ALGORITHM. Recursive graph bisection. The paper counts n log2(m / (n + 1)) bits for each row with n ids among a part
// of m columns. The rows' counts in two halves give the gain of moving each column to the other half. The columns of
// each half are sorted by gain and swapped pair by pair as long as the two gains have a positive sum, again and again.
// Then each half is divided likewise.
#include "layout/orders/bisection.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

namespace vismat {
namespace {

class Bisection {
 public:
  Bisection(const VisibilityMatrix& matrix, const BisectionOptions& options)
      : rows_of_column_(transpose(matrix)),
        options_(options),
        counts_(matrix.shape().rows),
        gain_(matrix.shape().columns) {
    logarithm_.resize(std::size_t{matrix.shape().columns} + 2);
    for (std::size_t i = 1; i < logarithm_.size(); ++i) logarithm_[i] = std::log2(static_cast<float>(i));
  }

  void order(std::span<std::uint32_t> part) {
    if (part.size() <= options_.smallest) return;
    const auto left = part.first(part.size() / 2), right = part.subspan(part.size() / 2);
    for (const std::uint32_t column : part) {
      for (const std::uint32_t r : rows_of_column_.row(column)) counts_[r] = {0, 0};
    }
    for (int side = 0; side < 2; ++side) {
      for (const std::uint32_t column : side == 0 ? left : right) {
        for (const std::uint32_t r : rows_of_column_.row(column)) ++counts_[r][side];
      }
    }
    for (std::uint32_t i = 0; i < options_.iterations && swap_pairs(left, right); ++i) {
    }
    order(left);
    order(right);
  }

 private:
  // Cost of a row with n ids in a half of size m.
  float cost(std::uint32_t n, std::size_t m) const {
    return static_cast<float>(n) * (logarithm_[m] - logarithm_[n + 1]);
  }

  bool swap_pairs(std::span<std::uint32_t> left, std::span<std::uint32_t> right) {
    const std::size_t sizes[2] = {left.size(), right.size()};
    for (int side = 0; side < 2; ++side) {
      for (const std::uint32_t column : side == 0 ? left : right) {
        float gain = 0;
        for (const std::uint32_t r : rows_of_column_.row(column)) {
          const std::uint32_t here = counts_[r][side], there = counts_[r][1 - side];
          gain += cost(here, sizes[side]) + cost(there, sizes[1 - side]) - cost(here - 1, sizes[side]) -
                  cost(there + 1, sizes[1 - side]);
        }
        gain_[column] = gain;
      }
      const auto half = side == 0 ? left : right;
      std::sort(half.begin(), half.end(),
                [&](auto a, auto b) { return std::pair(-gain_[a], a) < std::pair(-gain_[b], b); });
    }
    bool swapped = false;
    for (std::size_t i = 0; i < left.size() && gain_[left[i]] + gain_[right[i]] > 0; ++i) {
      for (const std::uint32_t r : rows_of_column_.row(left[i])) --counts_[r][0], ++counts_[r][1];
      for (const std::uint32_t r : rows_of_column_.row(right[i])) --counts_[r][1], ++counts_[r][0];
      std::swap(left[i], right[i]);
      swapped = true;
    }
    return swapped;
  }

  VisibilityMatrix rows_of_column_;
  BisectionOptions options_;
  std::vector<std::array<std::uint32_t, 2>> counts_;  // ids of each row in either half
  std::vector<float> gain_, logarithm_;
};

}  // namespace

Permutation order_by_bisection(const VisibilityMatrix& matrix, const BisectionOptions& options) {
  std::vector<std::uint32_t> order(matrix.shape().columns);
  std::iota(order.begin(), order.end(), 0u);
  Bisection(matrix, options).order(order);
  return Permutation::from_old_of_new(std::move(order));
}

}  // namespace vismat
