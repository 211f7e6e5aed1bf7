// ALGORITHM. Distances of all pairs of columns. From bits: popcounts of a few points against all, so that these few
// stay in the cache. From the index: each one of a point adds 1 to all points with a one in that row, and |a xor b| =
// |a| + |b| - 2 |a and b|. Their measured costs, in nanoseconds below, decide which is cheaper.
#include "layout/points/pair_distances.h"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>

#include "matrix/base/parallel.h"

namespace vismat {
namespace {

constexpr std::uint32_t greatest_distance = std::numeric_limits<Distance16>::max();
constexpr std::uint32_t strip = 8;  // points a task

Distance16 cut(std::uint32_t distance) {
  return static_cast<Distance16>(std::min(distance, greatest_distance));
}

void rows_from_bits(const BitRows& bits, const PairDistances::Take& take, unsigned threads) {
  const std::uint32_t count = bits.shape().rows;
  parallel_for((count + strip - 1) / strip, threads, [&](std::uint64_t s) {
    const auto first = static_cast<std::uint32_t>(s * strip), end = std::min(count, first + strip);
    std::array<std::vector<Distance16>, strip> rows;
    rows.fill(std::vector<Distance16>(count));
    for (std::uint32_t q = 0; q < count; ++q) {
      for (std::uint32_t p = first; p < end; ++p)
        rows[p - first][q] = cut(hamming_distance(bits.row(p), bits.row(q)));
    }
    for (std::uint32_t p = first; p < end; ++p) take(p, rows[p - first]);
  });
}

// Count is wide enough for any weight.
template <typename Count>
void rows_from_index(const SparsePoints& points, const std::vector<std::uint64_t>& first_of_row,
                     const std::vector<std::uint32_t>& points_of_row, const PairDistances::Take& take,
                     unsigned threads) {
  const std::uint32_t count = points.size();
  std::vector<std::uint32_t> weights(count);
  for (std::uint32_t p = 0; p < count; ++p) weights[p] = points.weight(p);
  parallel_for((count + strip - 1) / strip, threads, [&](std::uint64_t s) {
    std::vector<Count> shared(count);
    std::vector<Distance16> row(count);
    const auto first = static_cast<std::uint32_t>(s * strip), end = std::min(count, first + strip);
    for (std::uint32_t p = first; p < end; ++p) {
      std::fill(shared.begin(), shared.end(), Count{0});
      for (const std::uint32_t r : points.ones(p)) {
        for (std::uint64_t i = first_of_row[r]; i < first_of_row[r + 1]; ++i) ++shared[points_of_row[i]];
      }
      for (std::uint32_t q = 0; q < count; ++q)
        row[q] = cut(weights[p] + weights[q] - 2 * static_cast<std::uint32_t>(shared[q]));
      take(p, row);
    }
  });
}

}  // namespace

PairDistances::PairDistances(const SparsePoints& points, std::uint64_t most_bytes, unsigned threads)
    : points_(points) {
  const std::uint32_t count = points.size();
  std::vector<std::uint64_t> in_row(points.rows(), 0);
  for (std::uint32_t p = 0; p < count; ++p) {
    for (const std::uint32_t r : points.ones(p)) ++in_row[r];
  }
  // Nanoseconds: an addition of the index .8, a word of bits .16 and 8 more a pair.
  double index_cost = 0;
  for (const std::uint64_t n : in_row) index_cost += .8 * static_cast<double>(n) * static_cast<double>(n);
  const double bits_cost = (.16 * points.rows() / 64 + 8) * count * count;
  if (bits_cost < index_cost) {
    bits_ = BitRows(Shape{count, points.rows()});
    for (std::uint32_t p = 0; p < count; ++p) {
      for (const std::uint32_t r : points.ones(p)) bits_.set(p, r);
    }
  } else {
    first_of_row_.assign(std::size_t{points.rows()} + 2, 0);
    for (std::uint32_t r = 0; r < points.rows(); ++r) first_of_row_[r + 2] = in_row[r];
    std::partial_sum(first_of_row_.begin(), first_of_row_.end(), first_of_row_.begin());
    points_of_row_.resize(first_of_row_.back());
    for (std::uint32_t p = 0; p < count; ++p) {
      for (const std::uint32_t r : points.ones(p)) points_of_row_[first_of_row_[r + 1]++] = p;
    }
  }
  if (std::uint64_t{2} * count * count > most_bytes) return;
  std::vector<Distance16> table(std::size_t{count} * count);
  make_rows([&](std::uint32_t p,
                auto row) { std::copy(row.begin(), row.end(), table.begin() + std::ptrdiff_t{p} * count); },
            threads);
  table_ = std::move(table);
  bits_ = {};
  first_of_row_ = {};
  points_of_row_ = {};
}

void PairDistances::make_rows(const Take& take, unsigned threads) const {
  if (bits_.shape().rows > 0) {
    rows_from_bits(bits_, take, threads);
    return;
  }
  std::uint32_t heaviest = 0;
  for (std::uint32_t p = 0; p < size(); ++p) heaviest = std::max(heaviest, points_.weight(p));
  if (heaviest <= greatest_distance)
    rows_from_index<std::uint16_t>(points_, first_of_row_, points_of_row_, take, threads);
  else
    rows_from_index<std::uint32_t>(points_, first_of_row_, points_of_row_, take, threads);
}

void PairDistances::each_row(const Take& take, unsigned threads) const {
  if (!kept()) {
    make_rows(take, threads);
    return;
  }
  const std::size_t count = size();
  parallel_for((count + strip - 1) / strip, threads, [&](std::uint64_t s) {
    for (std::size_t p = s * strip; p < std::min(count, (s + 1) * strip); ++p)
      take(static_cast<std::uint32_t>(p), std::span(table_).subspan(p * count, count));
  });
}

}  // namespace vismat
