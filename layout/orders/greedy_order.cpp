// ALGORITHM. Nearest unvisited neighbour in Hamming space. Two sets whose sizes differ by s differ in at least s
// columns. Rows are kept in a list sorted by size, and from the last row's place the search goes outward on both sides
// until the size difference alone reaches the best distance found (the paper's secondary index). Placed rows leave the
// list; path-compressed links jump over its gaps. The computation of a distance stops when it exceeds the best so far.
//
// The limit: artificial 2 (24578 rows of 86 words) has 3.0e8 pairs, 2.6e10 pairs of words. Without the index they take
// 2-3 s on a core that XORs and counts 8 words in a cycle, 11 s at one word in a cycle.
#include "layout/orders/greedy_order.h"

#include <algorithm>
#include <cassert>
#include <numeric>
#include <utility>
#include <vector>

#include "matrix/bit_rows.h"

namespace vismat {
namespace {

std::vector<std::uint32_t> rows_by_size(const VisibilityMatrix& matrix) {
  std::vector<std::uint32_t> rows(matrix.shape().rows);
  std::iota(rows.begin(), rows.end(), 0u);
  std::stable_sort(rows.begin(), rows.end(),
                   [&](auto a, auto b) { return matrix.row(a).size() < matrix.row(b).size(); });
  return rows;
}

// The places 0 .. size - 1 in a row, from which places leave; free_from(i) is the first free one at or after
// i, free_to(i) the last free one at or before i. Paths are halved on the way, so a jump costs next to
// nothing.
class FreePlaces {
 public:
  explicit FreePlaces(std::uint32_t size)
      : after_(size + 2), before_(size + 2) {  // shifted by one: 0 and size + 1 stay
    std::iota(after_.begin(), after_.end(), 0u);
    std::iota(before_.begin(), before_.end(), 0u);
  }
  void leave(std::uint32_t i) {
    after_[i + 1] = i + 2;
    before_[i + 1] = i;
  }
  std::uint32_t free_from(std::uint32_t i) { return find(after_, i + 1) - 1; }  // size: none
  std::int64_t free_to(std::int64_t i) {
    return std::int64_t{find(before_, static_cast<std::uint32_t>(i + 1))} - 1;
  }  // -1: none

 private:
  static std::uint32_t find(std::vector<std::uint32_t>& link, std::uint32_t i) {
    while (link[i] != i) i = link[i] = link[link[i]];
    return i;
  }
  std::vector<std::uint32_t> after_, before_;
};

}  // namespace

Permutation order_rows_greedily(const VisibilityMatrix& matrix, const Progress& progress) {
  const std::uint32_t rows = matrix.shape().rows;
  const std::vector<std::uint32_t> row_of_place = rows_by_size(matrix);
  BitRows bits(matrix.shape());  // in order of size, so that the outward search reads memory in sequence
  std::vector<std::uint32_t> size(rows);
  for (std::uint32_t place = 0; place < rows; ++place) {
    const auto row = matrix.row(row_of_place[place]);
    size[place] = static_cast<std::uint32_t>(row.size());
    for (const std::uint32_t c : row) bits.set(place, c);
  }
  FreePlaces free(rows);
  std::vector<std::uint32_t> order;
  order.reserve(rows);
  for (std::uint32_t last = 0; order.size() < rows;) {
    order.push_back(row_of_place[last]);
    free.leave(last);
    std::uint32_t best = rows, best_distance = 0xffffffff;
    const auto consider = [&](std::uint32_t place) {
      const std::uint32_t distance = hamming_distance(bits.row(last), bits.row(place), best_distance);
      if (distance < best_distance ||
          (distance == best_distance && row_of_place[place] < row_of_place[best])) {
        best = place;
        best_distance = distance;
      }
    };
    std::int64_t down = free.free_to(last);
    std::uint32_t up = free.free_from(last);
    while (down >= 0 || up < rows) {  // the side with the smaller difference in size first
      const std::uint32_t below =
          down >= 0 ? size[last] - size[static_cast<std::uint32_t>(down)] : 0xffffffff;
      const std::uint32_t above = up < rows ? size[up] - size[last] : 0xffffffff;
      if (std::min(below, above) > best_distance) break;
      if (above <= below) {
        consider(up);
        up = free.free_from(up + 1);
      } else {
        consider(static_cast<std::uint32_t>(down));
        down = free.free_to(down - 1);
      }
    }
    last = best;
    if (progress) progress(order.size(), rows);
  }
  return Permutation::from_old_of_new(std::move(order));
}

Permutation order_rows_by_neighbours(const VisibilityMatrix& matrix, const VisibilityMatrix& neighbours) {
  const std::uint32_t rows = matrix.shape().rows;
  assert(neighbours.shape() == (Shape{rows, rows}));
  const BitRows bits(matrix);
  std::vector<bool> placed(rows, false);
  std::vector<std::uint32_t> order, path;  // path: placed rows that may still have a free neighbour
  order.reserve(rows);
  for (const std::uint32_t start : rows_by_size(matrix)) {
    if (placed[start]) continue;
    path.push_back(start);
    order.push_back(start);
    placed[start] = true;
    while (!path.empty()) {
      std::uint32_t best = rows, best_distance = 0xffffffff;
      for (const std::uint32_t n : neighbours.row(path.back())) {
        if (placed[n]) continue;
        // The new row comes behind the last one placed, wherever the walk found it.
        const std::uint32_t distance = hamming_distance(bits.row(order.back()), bits.row(n), best_distance);
        if (distance < best_distance) best = n, best_distance = distance;
      }
      if (best == rows) {
        path.pop_back();
        continue;
      }
      path.push_back(best);
      order.push_back(best);
      placed[best] = true;
    }
  }
  return Permutation::from_old_of_new(std::move(order));
}

}  // namespace vismat
