// ALGORITHM. Prim's spanning tree: it grows by the row that is nearest to it. Equal rows are collapsed first and joined
// to the first of them at the end. A distance is not computed if the two rows' sizes differ by as much as the row's
// distance from the tree so far (this avoids a third of them on levels, 2 % on the artificial city), and its
// computation stops once it exceeds that. Tried and left out: such bounds from 16 rows far apart avoid 84 % of the
// distances on the city, but only a third of the time.
//
// Where rows are sparse, an inverted index gives the distances of the row that joined to all others at once, and they
// grow with the square of the sides instead of the cube (docs/growth.md).
#include "layout/trees/nearest_tree.h"

#include <algorithm>
#include <cstdint>
#include <vector>

#include "matrix/bit_rows.h"
#include "matrix/points/distinct_columns.h"
#include "matrix/points/point_comparison.h"

namespace vismat {
namespace {

constexpr std::uint32_t unknown = 0xffffffff;

// A row that is not in the tree yet.
struct Free {
  std::uint32_t row, size, distance = unknown, nearest = 0;
};

// The row of the tree that each row joined when it became part of it; row 0 is there from the beginning. joined(row) is
// told each row that joins; distance(other, limit) is that from it to another, or some number above the limit.
template <typename Joined, typename Distance>
std::vector<std::uint32_t> parents_of(const SparsePoints& rows, const Joined& joined,
                                      const Distance& distance, const Progress& progress) {
  const std::uint32_t count = rows.size();
  std::vector<std::uint32_t> parents(count, 0);
  std::vector<Free> left;
  for (std::uint32_t r = 1; r < count; ++r) left.push_back({r, rows.weight(r)});
  for (std::uint32_t last = 0; !left.empty();) {
    joined(last);
    const std::uint32_t size = rows.weight(last);
    std::size_t best = 0;
    for (std::size_t i = 0; i < left.size(); ++i) {
      Free& free = left[i];
      if (std::max(size, free.size) - std::min(size, free.size) < free.distance) {
        const std::uint32_t to_last = distance(free.row, free.distance);
        if (to_last < free.distance) free.distance = to_last, free.nearest = last;
      }
      if (free.distance < left[best].distance ||
          (free.distance == left[best].distance && free.row < left[best].row))
        best = i;
    }
    last = left[best].row;
    parents[last] = left[best].nearest;
    left[best] = left.back();
    left.pop_back();
    if (progress) progress(count - left.size(), count);
  }
  return parents;
}

std::vector<std::uint32_t> parents_of(const SparsePoints& rows, const Progress& progress) {
  if (all_pairs_cost(rows).index_beats_limited_bits()) {
    const PointComparison comparison(rows);
    std::vector<std::uint32_t> distances;
    return parents_of(
        rows, [&](std::uint32_t row) { comparison.distances_of(row, distances); },
        [&](std::uint32_t other, std::uint32_t) { return distances[other]; }, progress);
  }
  const BitRows bits(transpose(matrix_of(rows)));
  std::uint32_t last = 0;
  return parents_of(
      rows, [&](std::uint32_t row) { last = row; },
      [&](std::uint32_t other, std::uint32_t limit) {
        return hamming_distance(bits.row(last), bits.row(other), limit);
      },
      progress);
}

}  // namespace

VisibilityMatrix nearest_tree(const VisibilityMatrix& matrix, const Progress& progress) {
  const std::uint32_t rows = matrix.shape().rows;
  const DistinctColumns kinds = distinct_columns(transpose(matrix));
  const std::vector<std::uint32_t> parents = parents_of(SparsePoints(kinds.matrix, false), progress);
  std::vector<std::uint32_t> first_of_kind(parents.size(), unknown);
  std::vector<std::vector<std::uint32_t>> neighbours(rows);
  const auto join = [&](std::uint32_t a, std::uint32_t b) {
    neighbours[a].push_back(b);
    neighbours[b].push_back(a);
  };
  for (std::uint32_t r = 0; r < rows; ++r) {
    std::uint32_t& first = first_of_kind[kinds.distinct_of_column[r]];
    if (first == unknown) {
      first = r;
    } else {
      join(first, r);
    }
  }
  for (std::uint32_t kind = 1; kind < parents.size(); ++kind)
    join(first_of_kind[kind], first_of_kind[parents[kind]]);
  for (auto& row : neighbours) std::ranges::sort(row);
  return VisibilityMatrix::from_rows(neighbours, rows);
}

}  // namespace vismat
