#include "layout/distinct_columns.h"

#include <algorithm>
#include <numeric>
#include <unordered_map>
#include <utility>

namespace vismat {

DistinctColumns distinct_columns(const VisibilityMatrix& matrix) {
  const VisibilityMatrix columns = transpose(matrix);
  DistinctColumns result;
  std::unordered_multimap<std::uint64_t, std::uint32_t> kind_of_hash;
  std::vector<std::uint32_t> first_of_kind;
  for (std::uint32_t c = 0; c < columns.shape().rows; ++c) {
    const auto rows = columns.row(c);
    std::uint64_t hash = 0xcbf29ce484222325u;
    for (const std::uint32_t r : rows) hash = (hash ^ r) * 0x9e3779b97f4a7c15u;
    auto [place, end] = kind_of_hash.equal_range(hash);
    while (place != end && !std::ranges::equal(columns.row(first_of_kind[place->second]), rows)) ++place;
    if (place == end) {
      place = kind_of_hash.emplace(hash, static_cast<std::uint32_t>(first_of_kind.size()));
      first_of_kind.push_back(c);
    }
    result.distinct_of_column.push_back(place->second);
  }
  std::vector<std::vector<std::uint32_t>> kinds;
  for (const std::uint32_t c : first_of_kind)
    kinds.emplace_back(columns.row(c).begin(), columns.row(c).end());
  result.matrix = transpose(VisibilityMatrix::from_rows(kinds, matrix.shape().rows));
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
