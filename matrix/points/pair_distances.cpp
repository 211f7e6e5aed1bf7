#include "matrix/points/pair_distances.h"

#include <algorithm>
#include <limits>

#include "matrix/base/parallel.h"

namespace vismat {
namespace {

constexpr std::uint32_t greatest_distance = std::numeric_limits<Distance16>::max();

Distance16 cut(std::uint32_t distance) {
  return static_cast<Distance16>(std::min(distance, greatest_distance));
}

}  // namespace

PairDistances::PairDistances(const SparsePoints& points, std::uint64_t most_bytes, unsigned threads)
    : size_(points.size()), comparison_(points) {
  const std::size_t count = size_;
  if (std::uint64_t{2} * count * count > most_bytes) return;
  table_.resize(count * count);
  comparison_->each_row(
      [&](std::uint32_t p, std::span<const std::uint32_t> distances) {
        std::ranges::transform(distances, table_.begin() + static_cast<std::ptrdiff_t>(p * count), cut);
      },
      threads);
  comparison_.reset();
}

void PairDistances::each_row(const Take& take, unsigned threads) const {
  const std::size_t count = size_;
  if (comparison_) {
    comparison_->each_row(
        [&](std::uint32_t p, std::span<const std::uint32_t> distances) {
          std::vector<Distance16> row(count);
          std::ranges::transform(distances, row.begin(), cut);
          take(p, row);
        },
        threads);
    return;
  }
  parallel_for(count, threads, [&](std::uint64_t p) {
    take(static_cast<std::uint32_t>(p), std::span(table_).subspan(p * count, count));
  });
}

}  // namespace vismat
