#include "layout/cost.h"

#include <vector>

namespace vismat {

std::uint64_t count_runs(const VisibilityMatrix& matrix) {
  std::uint64_t runs = 0;
  for (std::uint32_t r = 0; r < matrix.shape().rows; ++r) {
    const auto ids = matrix.row(r);
    for (std::size_t i = 0; i < ids.size(); ++i) runs += i == 0 || ids[i] != ids[i - 1] + 1;
  }
  return runs;
}

std::uint64_t count_runs(const VisibilityMatrix& matrix, const Permutation& columns) {
  const auto place_of = columns.new_of_old();
  std::vector<std::uint64_t> ones(columns.size() / 64 + 1, 0);  // of one row, by place; bit 0 is no place
  std::uint64_t runs = 0;
  for (std::uint32_t r = 0; r < matrix.shape().rows; ++r) {
    const auto ids = matrix.row(r);
    for (const std::uint32_t c : ids)
      ones[(place_of[c] + std::size_t{1}) / 64] |= std::uint64_t{1} << (place_of[c] + 1) % 64;
    for (const std::uint32_t c : ids) runs += ~ones[place_of[c] / 64] >> place_of[c] % 64 & 1;
    for (const std::uint32_t c : ids) ones[(place_of[c] + std::size_t{1}) / 64] = 0;
  }
  return runs;
}

double mean_runs_of_random(const VisibilityMatrix& matrix) {
  const double n = matrix.shape().columns;
  double sum = 0;
  for (std::uint32_t r = 0; r < matrix.shape().rows; ++r) {
    const auto k = static_cast<double>(matrix.row(r).size());
    if (k > 0) sum += k * (n - k + 1) / n;
  }
  return sum;
}

}  // namespace vismat
