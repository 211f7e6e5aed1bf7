#include "matrix/points/distinct_columns.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace vismat {
namespace {

VisibilityMatrix matrix_of(const SparsePoints& points, std::uint32_t empty_columns) {
  std::vector<std::uint64_t> offsets = {0};
  std::vector<std::uint32_t> rows;
  for (std::uint32_t p = 0; p < points.size(); ++p) {
    rows.insert(rows.end(), points.ones(p).begin(), points.ones(p).end());
    offsets.push_back(rows.size());
  }
  offsets.insert(offsets.end(), empty_columns, rows.size());
  return transpose(VisibilityMatrix::from_csr({points.size() + empty_columns, points.rows()},
                                              std::move(offsets), std::move(rows)));
}

}  // namespace

VisibilityMatrix matrix_of(const SparsePoints& points) {
  return matrix_of(points, 0);
}

DistinctColumns distinct_columns(const VisibilityMatrix& matrix) {
  const SparsePoints points(matrix);
  std::vector<std::uint32_t> all(points.size());
  std::iota(all.begin(), all.end(), 0u);
  std::vector<bool> empty(matrix.shape().columns, true);
  for (const std::uint32_t c : matrix.ids()) empty[c] = false;
  DistinctColumns result;
  result.distinct_of_column.assign(matrix.shape().columns, points.size());  // what empty ones keep
  std::uint32_t begun = 0;                                                  // kinds
  for (const std::uint32_t c : points.order_of_columns(all).old_of_new()) {
    if (empty[c]) break;
    begun += begun < points.size() && c == points.column(begun);
    result.distinct_of_column[c] = begun - 1;
  }
  result.matrix = matrix_of(points, std::find(empty.begin(), empty.end(), true) != empty.end());
  return result;
}

Permutation unfold(const Permutation& order_of_distinct,
                   const std::vector<std::uint32_t>& distinct_of_column) {
  std::vector<std::uint32_t> order(distinct_of_column.size());
  std::iota(order.begin(), order.end(), 0u);
  const auto place = order_of_distinct.new_of_old();
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) {
    return place[distinct_of_column[a]] < place[distinct_of_column[b]];
  });
  return Permutation::from_old_of_new(std::move(order));
}

}  // namespace vismat
