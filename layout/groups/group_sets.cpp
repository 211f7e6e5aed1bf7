#include "layout/groups/group_sets.h"

#include <algorithm>
#include <bit>
#include <numeric>
#include <utility>

namespace vismat {
namespace {

constexpr std::uint32_t folded_bits = 512, no_slot = InvertedIndex::no_set;

// Calls visit(column, in_a, in_b) for each column that one of the two ascending lists has.
template <typename Visit>
void for_each_of_either(std::span<const std::uint32_t> a, std::span<const std::uint32_t> b,
                        const Visit& visit) {
  std::size_t i = 0, j = 0;
  while (i < a.size() || j < b.size()) {
    const bool in_a = j == b.size() || (i < a.size() && a[i] <= b[j]),
               in_b = i == a.size() || (j < b.size() && b[j] <= a[i]);
    visit(in_a ? a[i] : b[j], in_a, in_b);
    i += in_a;
    j += in_b;
  }
}

void visit_bits(std::span<const std::uint64_t> a, std::span<const std::uint64_t> b,
                const GroupSets::Visit& visit) {
  for (std::size_t w = 0; w < a.size(); ++w) {
    for (std::uint64_t differ = a[w] ^ b[w]; differ != 0; differ &= differ - 1) {
      const auto bit = static_cast<unsigned>(std::countr_zero(differ));
      visit(static_cast<std::uint32_t>(64 * w + bit), (a[w] >> bit & 1) != 0);
    }
  }
}

void visit_lists(std::span<const std::uint32_t> a, std::span<const std::uint32_t> b,
                 const GroupSets::Visit& visit) {
  for_each_of_either(a, b, [&](std::uint32_t column, bool in_a, bool in_b) {
    if (in_a != in_b) visit(column, in_a);
  });
}

}  // namespace

GroupSets::Form GroupSets::cheaper(const VisibilityMatrix& rows) {
  return all_pairs_cost(rows).index_beats_limited_bits() ? Form::lists : Form::bits;
}

GroupSets::GroupSets(const VisibilityMatrix& rows, Form form) : rows_(rows), form_(form) {
  const auto [groups, columns] = rows.shape();
  for (std::uint32_t g = 0; g < groups; ++g) size_.push_back(static_cast<std::uint32_t>(rows.row(g).size()));
  if (listed()) {
    lists_.resize(groups);
    is_row_.assign(groups, true);
    slot_.resize(groups);
    std::iota(slot_.begin(), slot_.end(), 0u);
    slots_ = used_slots_ = groups;
    make_index();
  } else {
    bits_ = BitRows(rows);
    folded_ = BitRows({groups, std::min(folded_bits, columns)});
    for (std::uint32_t g = 0; g < groups; ++g) fold(g);
  }
}

std::uint32_t GroupSets::distance(std::uint32_t a, std::uint32_t b, std::uint32_t limit) const {
  if (listed()) {
    std::uint32_t distance = 0;
    for_each_of_either(list(a), list(b),
                       [&](std::uint32_t, bool in_a, bool in_b) { distance += in_a != in_b; });
    return distance;
  }
  const std::uint32_t folded = hamming_distance(folded_.row(a), folded_.row(b), limit);
  return folded > limit ? folded : hamming_distance(bits_.row(a), bits_.row(b), limit);
}

std::vector<std::uint32_t> GroupSets::common_with(std::uint32_t group,
                                                  std::span<const std::uint32_t> others) const {
  std::vector<std::uint64_t> own((std::size_t{rows_.shape().columns} + 63) / 64, 0);
  for (const std::uint32_t c : list(group)) own[c / 64] |= std::uint64_t{1} << (c % 64);
  std::vector<std::uint32_t> common;
  for (const std::uint32_t other : others) {
    std::uint32_t shared = 0;
    for (const std::uint32_t c : list(other))
      shared += static_cast<std::uint32_t>(own[c / 64] >> (c % 64) & 1);
    common.push_back(shared);
  }
  return common;
}

void GroupSets::each_difference(std::uint32_t a, std::uint32_t b, const Visit& visit) const {
  listed() ? visit_lists(list(a), list(b), visit) : visit_bits(bits_.row(a), bits_.row(b), visit);
}

void GroupSets::each_difference(std::span<const std::uint32_t> columns, std::uint32_t group,
                                const Visit& visit) const {
  if (listed()) return visit_lists(columns, list(group), visit);
  BitRows own({1, rows_.shape().columns});
  for (const std::uint32_t c : columns) own.set(0, c);
  visit_bits(std::as_const(own).row(0), bits_.row(group), visit);
}

void GroupSets::join(std::uint32_t into, std::uint32_t from) {
  if (!listed()) {
    const auto whole = bits_.row(into);
    size_[into] = 0;
    for (std::size_t w = 0; w < whole.size(); ++w) {
      whole[w] |= std::as_const(bits_).row(from)[w];
      size_[into] += static_cast<std::uint32_t>(std::popcount(whole[w]));
    }
    return fold(into);
  }
  std::vector<std::uint32_t> whole;
  whole.reserve(size_[into] + std::size_t{size_[from]});
  for_each_of_either(list(into), list(from), [&](std::uint32_t column, bool in_into, bool) {
    // A column of both stays with the slot of `from`, too, which counts for nothing: to erase each of them as they come
    // took a third of the time of the merges that search by the index.
    if (!in_into && indexed_) index_.give(column, slot_[from], slot_[into]);
    whole.push_back(column);
  });
  whole.shrink_to_fit();
  size_[into] = static_cast<std::uint32_t>(whole.size());
  lists_[into] = std::move(whole);
  is_row_[into] = false;
  lists_[from] = {};
  slot_[from] = no_slot;
  // An eighth of slots without use costs searches an eighth more time at most.
  if (--used_slots_ <= slots_ - slots_ / 8 && indexed_) close_gaps();
}

void GroupSets::drop_index() {
  index_ = {};
  indexed_ = false;
}

void GroupSets::make_index() {
  if (indexed_) return;
  std::vector<std::uint32_t> group_of_slot, room(rows_.shape().columns, 0);
  for (std::uint32_t g = 0; g < slot_.size(); ++g) {
    if (slot_[g] == no_slot) continue;
    slot_[g] = static_cast<std::uint32_t>(group_of_slot.size());
    group_of_slot.push_back(g);
  }
  slots_ = used_slots_ = static_cast<std::uint32_t>(group_of_slot.size());
  for (const std::uint32_t c : rows_.ids())
    ++room[c];  // groups can come to be as many as rows when these move
  index_ = InvertedIndex(slots_, room, [&](std::uint32_t slot) { return list(group_of_slot[slot]); });
  indexed_ = true;
}

void GroupSets::close_gaps() {
  if (used_slots_ == slots_) return;
  std::vector<std::uint32_t> new_of_old(slots_, no_slot);
  slots_ = 0;
  for (std::uint32_t& slot : slot_) {  // which ascend, as the groups do
    if (slot != no_slot) slot = new_of_old[slot] = slots_++;
  }
  index_.renumber(new_of_old);
}

void GroupSets::begin_moves(std::span<const std::uint32_t> alive,
                            std::span<const std::uint32_t> group_of_row) {
  const std::size_t columns = rows_.shape().columns;
  if (listed()) {
    close_gaps();  // what moves needs the room
    counts_.resize(size_.size());
    for (const std::uint32_t g : alive) {
      if (is_row_[g]) lists_[g].assign(rows_.row(g).begin(), rows_.row(g).end());
      is_row_[g] = false;
      counts_[g].assign(lists_[g].size(), 0);
    }
    for (std::uint32_t r = 0; r < group_of_row.size(); ++r) {
      const auto& list = lists_[group_of_row[r]];
      std::size_t at = 0;
      for (const std::uint32_t c : rows_.row(r)) {
        while (list[at] < c) ++at;
        ++counts_[group_of_row[r]][at];
      }
    }
    return;
  }
  place_.assign(size_.size(), 0);
  for (std::uint32_t i = 0; i < alive.size(); ++i) place_[alive[i]] = i;
  seen_.assign(alive.size() * columns, 0);
  for (std::uint32_t r = 0; r < group_of_row.size(); ++r) {
    std::uint32_t* const seen = seen_by(group_of_row[r]);
    for (const std::uint32_t c : rows_.row(r)) ++seen[c];
  }
}

void GroupSets::end_moves() {
  seen_ = {};
  place_ = {};
  counts_ = {};
}

std::uint32_t GroupSets::alone(std::uint32_t row, std::uint32_t group) const {
  std::uint32_t alone = 0;
  if (listed()) {
    const auto& list = lists_[group];
    std::size_t at = 0;
    for (const std::uint32_t c : rows_.row(row)) {
      while (list[at] < c) ++at;
      alone += counts_[group][at] == 1;
    }
    return alone;
  }
  const std::uint32_t* const seen = seen_.data() + std::size_t{place_[group]} * rows_.shape().columns;
  for (const std::uint32_t c : rows_.row(row)) alone += seen[c] == 1;
  return alone;
}

void GroupSets::move(std::uint32_t row, std::uint32_t from, std::uint32_t to) {
  listed() ? move_list(row, from, to) : move_bits(row, from, to);
}

void GroupSets::move_bits(std::uint32_t row, std::uint32_t from, std::uint32_t to) {
  std::uint32_t *const seen_from = seen_by(from), *const seen_to = seen_by(to);
  for (const std::uint32_t c : rows_.row(row)) {
    if (seen_to[c]++ == 0) {
      bits_.set(to, c);
      ++size_[to];
    }
    if (--seen_from[c] == 0) {
      bits_.row(from)[c / 64] &= ~(std::uint64_t{1} << (c % 64));
      --size_[from];
    }
  }
  fold(from);
  fold(to);
}

void GroupSets::move_list(std::uint32_t row, std::uint32_t from, std::uint32_t to) {
  std::size_t kept = 0, at = 0;
  for_each_of_either(rows_.row(row), lists_[from], [&](std::uint32_t c, bool in_row, bool) {
    const std::uint32_t left = counts_[from][at++] - in_row;
    if (left == 0) return index_.erase(c, slot_[from]);
    lists_[from][kept] = c;
    counts_[from][kept++] = left;
  });
  lists_[from].resize(kept);
  counts_[from].resize(kept);
  size_[from] = static_cast<std::uint32_t>(kept);

  std::vector<std::uint32_t> list, counts;
  list.reserve(size_[to] + rows_.row(row).size());
  counts.reserve(list.capacity());
  at = 0;
  for_each_of_either(rows_.row(row), lists_[to], [&](std::uint32_t c, bool in_row, bool in_to) {
    list.push_back(c);
    counts.push_back(in_row + (in_to ? counts_[to][at] : 0));
    at += in_to;
    if (!in_to) index_.insert(c, slot_[to]);
  });
  lists_[to] = std::move(list);
  counts_[to] = std::move(counts);
  size_[to] = static_cast<std::uint32_t>(lists_[to].size());
}

void GroupSets::fold(std::uint32_t group) {
  const auto words = std::as_const(bits_).row(group);
  const auto folded = folded_.row(group);
  std::ranges::fill(folded, 0);
  for (std::size_t w = 0; w < words.size(); ++w) folded[w % folded.size()] ^= words[w];
}

}  // namespace vismat
