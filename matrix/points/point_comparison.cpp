// ALGORITHM. Distances of points to all others. From bits: popcounts, of a few points against all so that these few stay
// in the cache. From the index: each one of a point adds 1 to all points with a one in that row, and |a xor b| = |a| +
// |b| - 2 |a and b|.
#include "matrix/points/point_comparison.h"

#include <algorithm>
#include <array>
#include <limits>

namespace vismat {
namespace {

constexpr std::uint32_t strip = 8;  // points a task

// Count is wide enough for any weight.
template <typename Count>
void distances_from_index(const InvertedIndex& index, std::span<const std::uint32_t> weights,
                          std::span<const std::uint32_t> ones, std::vector<std::uint32_t>& distances) {
  std::vector<Count> common(weights.size(), Count{0});
  index.count_common(ones, common.data());
  const auto weight = static_cast<std::uint32_t>(ones.size());
  for (std::size_t q = 0; q < weights.size(); ++q)
    distances[q] = weight + weights[q] - 2 * static_cast<std::uint32_t>(common[q]);
}

}  // namespace

AllPairsCost all_pairs_cost(const SparsePoints& points) {
  std::vector<std::uint32_t> in_row(points.rows(), 0);
  for (std::uint32_t p = 0; p < points.size(); ++p) {
    for (const std::uint32_t r : points.ones(p)) ++in_row[r];
  }
  return all_pairs_cost(points.size(), in_row);
}

PointComparison::PointComparison(const SparsePoints& points) : points_(points) {
  const std::uint32_t count = points.size();
  for (std::uint32_t p = 0; p < count; ++p) {
    weights_.push_back(points.weight(p));
    wide_ = wide_ || weights_.back() > std::numeric_limits<std::uint16_t>::max();
  }
  const AllPairsCost cost = all_pairs_cost(points);
  indexed_ = cost.by_index <= cost.by_bits;
  if (indexed_) {
    index_ = InvertedIndex(count, points.rows(), [&](std::uint32_t p) { return points.ones(p); });
  } else {
    bits_ = BitRows(Shape{count, points.rows()});
    for (std::uint32_t p = 0; p < count; ++p) {
      for (const std::uint32_t r : points.ones(p)) bits_.set(p, r);
    }
  }
}

void PointComparison::distances_of(std::uint32_t p, std::vector<std::uint32_t>& distances) const {
  distances.resize(size());
  if (!indexed_) {
    for (std::uint32_t q = 0; q < size(); ++q) distances[q] = hamming_distance(bits_.row(p), bits_.row(q));
  } else if (wide_) {
    distances_from_index<std::uint32_t>(index_, weights_, points_.ones(p), distances);
  } else {
    distances_from_index<std::uint16_t>(index_, weights_, points_.ones(p), distances);
  }
}

void PointComparison::each_row(const Take& take, unsigned threads, const Progress& progress) const {
  const std::uint32_t count = size();
  const auto one_strip = [&](std::uint64_t s) {
    const auto first = static_cast<std::uint32_t>(s * strip), end = std::min(count, first + strip);
    std::array<std::vector<std::uint32_t>, strip> rows;
    if (indexed_) {
      for (std::uint32_t p = first; p < end; ++p) {
        distances_of(p, rows[0]);
        take(p, rows[0]);
      }
      return;
    }
    rows.fill(std::vector<std::uint32_t>(count));
    for (std::uint32_t q = 0; q < count; ++q) {
      for (std::uint32_t p = first; p < end; ++p)
        rows[p - first][q] = hamming_distance(bits_.row(p), bits_.row(q));
    }
    for (std::uint32_t p = first; p < end; ++p) take(p, rows[p - first]);
  };
  parallel_for((std::uint64_t{count} + strip - 1) / strip, threads, one_strip, progress);
}

}  // namespace vismat
