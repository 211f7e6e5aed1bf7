#include "matrix/points/inverted_index.h"

#include <algorithm>
#include <cassert>

namespace vismat {

InvertedIndex::InvertedIndex(std::uint32_t sets, std::uint32_t ids, const IdsOf& ids_of)
    : first_(std::size_t{ids} + 1, 0), count_(ids, 0) {
  for (std::uint32_t s = 0; s < sets; ++s) {
    for (const std::uint32_t id : ids_of(s)) ++first_[id + 1];
  }
  fill(sets, ids_of);
}

InvertedIndex::InvertedIndex(std::uint32_t sets, std::span<const std::uint32_t> room, const IdsOf& ids_of)
    : first_(room.size() + 1, 0), count_(room.size(), 0) {
  std::ranges::copy(room, first_.begin() + 1);
  fill(sets, ids_of);
}

// first_[id + 1] has the room of each id.
void InvertedIndex::fill(std::uint32_t sets, const IdsOf& ids_of) {
  for (std::size_t id = 0; id < count_.size(); ++id) first_[id + 1] += first_[id];
  sets_.resize(first_.back());
  for (std::uint32_t s = 0; s < sets; ++s) {
    for (const std::uint32_t id : ids_of(s)) sets_[first_[id] + count_[id]++] = s;
  }
}

void InvertedIndex::erase(std::uint32_t id, std::uint32_t set) {
  const auto begin = sets_.begin() + static_cast<std::ptrdiff_t>(first_[id]), end = begin + count_[id];
  const auto at = std::lower_bound(begin, end, set);
  assert(at != end && *at == set);
  std::copy(at + 1, end, at);
  --count_[id];
}

void InvertedIndex::insert(std::uint32_t id, std::uint32_t set) {
  assert(first_[id] + count_[id] < first_[id + 1]);
  const auto begin = sets_.begin() + static_cast<std::ptrdiff_t>(first_[id]), end = begin + count_[id];
  const auto at = std::lower_bound(begin, end, set);
  std::copy_backward(at, end, end + 1);
  *at = set;
  ++count_[id];
}

void InvertedIndex::give(std::uint32_t id, std::uint32_t from, std::uint32_t to) {
  const auto begin = sets_.begin() + static_cast<std::ptrdiff_t>(first_[id]), end = begin + count_[id];
  const auto old = std::lower_bound(begin, end, from), at = std::lower_bound(begin, end, to);
  assert(old != end && *old == from && (at == end || *at != to));
  if (at <= old) {
    std::copy_backward(at, old, old + 1);
    *at = to;
  } else {
    *std::copy(old + 1, at, old) = to;
  }
}

void InvertedIndex::renumber(std::span<const std::uint32_t> new_of_old) {
  for (std::size_t id = 0; id < count_.size(); ++id) {
    std::uint32_t* const sets = sets_.data() + first_[id];
    std::uint32_t kept = 0;
    for (std::uint32_t i = 0; i < count_[id]; ++i) {
      sets[kept] = new_of_old[sets[i]];
      kept += sets[kept] != no_set;
    }
    count_[id] = kept;
  }
}

AllPairsCost all_pairs_cost(std::uint32_t sets, std::span<const std::uint32_t> sets_with_id) {
  // An addition of the index takes .8, a word of bits .16, and each pair of sets 8 more.
  AllPairsCost cost;
  for (const double n : sets_with_id) cost.by_index += .8 * n * n;
  const double words = static_cast<double>(sets_with_id.size()) / 64;
  cost.by_bits = (.16 * words + 8) * sets * sets;
  return cost;
}

AllPairsCost all_pairs_cost(const VisibilityMatrix& rows) {
  std::vector<std::uint32_t> of_column(rows.shape().columns, 0);
  for (const std::uint32_t c : rows.ids()) ++of_column[c];
  return all_pairs_cost(rows.shape().rows, of_column);
}

}  // namespace vismat
