#include "layout/row_groups.h"

#include <algorithm>
#include <bit>
#include <unordered_map>
#include <utility>

#include "matrix/random.h"

namespace vismat {
namespace {

// The first of each row's equals.
std::vector<std::uint32_t> first_equals(const VisibilityMatrix& matrix) {
  std::unordered_multimap<std::uint64_t, std::uint32_t> met;
  std::vector<std::uint32_t> first(matrix.shape().rows);
  for (std::uint32_t r = 0; r < first.size(); ++r) {
    const auto ids = matrix.row(r);
    std::uint64_t hash = ids.size();
    for (const std::uint32_t id : ids) hash = Random(hash ^ id).next();
    const auto [begin, end] = met.equal_range(hash);
    const auto same =
        std::find_if(begin, end, [&](const auto& entry) { return std::ranges::equal(matrix.row(entry.second), ids); });
    first[r] = same == end ? r : same->second;
    if (same == end) met.emplace(hash, r);
  }
  return first;
}

}  // namespace

RowGroups::RowGroups(const VisibilityMatrix& matrix, const GroupingOptions& options)
    : bits_(matrix),
      size_(matrix.shape().rows),
      members_(matrix.shape().rows, 0),
      most_(matrix.shape().rows),
      room_(options.room_in_column),
      group_of_row_(first_equals(matrix)),
      place_(matrix.shape().rows, none),
      of_size_(matrix.shape().columns + std::size_t{1}),
      place_in_size_(matrix.shape().rows) {
  const auto [rows, columns] = matrix.shape();
  for (std::uint32_t r = 0; r < rows; ++r) {
    size_[r] = static_cast<std::uint32_t>(matrix.row(r).size());
    most_[r] = size_[r] + static_cast<std::uint32_t>(options.lost_in_row * (columns - size_[r]));
    if (group_of_row_[r] == r) insert(r);
    ++members_[group_of_row_[r]];
  }
}

std::uint64_t RowGroups::score(std::uint32_t a, std::uint32_t b, std::uint64_t limit) const {
  const std::uint64_t fewer = std::min(members_[a], members_[b]), both = std::uint64_t{size_[a]} + size_[b];
  const auto far = static_cast<std::uint32_t>(std::min<std::uint64_t>(limit / fewer, both));
  const std::uint32_t distance = hamming_distance(bits_.row(a), bits_.row(b), far);
  if (distance > far) return unbounded;
  const std::uint64_t common = (both - distance) / 2;
  if (both - common > std::min(most_[a], most_[b])) return unbounded;
  const std::uint64_t score = members_[a] * (size_[b] - common) + members_[b] * (size_[a] - common);
  return score <= limit && !has_room(a, b) ? unbounded : score;
}

bool RowGroups::has_room(std::uint32_t a, std::uint32_t b) const {
  if (room_.empty()) return true;
  const auto in_a = bits_.row(a), in_b = bits_.row(b);
  for (std::size_t w = 0; w < in_a.size(); ++w) {
    for (std::uint64_t differ = in_a[w] ^ in_b[w]; differ != 0; differ &= differ - 1) {
      const auto bit = static_cast<unsigned>(std::countr_zero(differ));
      if (room_[64 * w + bit] < (in_a[w] >> bit & 1 ? members_[b] : members_[a])) return false;
    }
  }
  return true;
}

RowGroups::Pair RowGroups::best_partner(std::uint32_t group) const {
  Pair best;
  const auto look_at = [&](std::uint32_t size) {
    for (const std::uint32_t other : of_size_[size]) {
      if (other == group) continue;
      const std::uint64_t score = this->score(group, other, best.score);
      if (score < best.score || (score == best.score && score != unbounded && other < best.partner))
        best = {score, other};
    }
  };
  const std::uint32_t own = size_[group], columns = bits_.shape().columns;
  look_at(own);
  bool smaller = true, larger = true;
  for (std::uint32_t away = 1; smaller || larger; ++away) {
    smaller = smaller && away <= own && away <= best.score;
    larger = larger && away <= columns - own && std::uint64_t{away} * members_[group] <= best.score &&
             own + away <= most_[group];
    if (smaller) look_at(own - away);
    if (larger) look_at(own + away);
  }
  return best;
}

void RowGroups::merge(std::uint32_t into, std::uint32_t from) {
  remove(into);
  remove(from);
  const auto whole = bits_.row(into);
  const auto part = std::as_const(bits_).row(from);
  std::uint32_t size = 0;
  for (std::size_t w = 0; w < whole.size(); ++w) {
    for (std::uint64_t differ = room_.empty() ? 0 : whole[w] ^ part[w]; differ != 0; differ &= differ - 1) {
      const auto bit = static_cast<unsigned>(std::countr_zero(differ));
      room_[64 * w + bit] -= whole[w] >> bit & 1 ? members_[from] : members_[into];
    }
    whole[w] |= part[w];
    size += static_cast<std::uint32_t>(std::popcount(whole[w]));
  }
  size_[into] = size;
  members_[into] += members_[from];
  most_[into] = std::min(most_[into], most_[from]);
  group_of_row_[from] = into;
  insert(into);
}

Partition RowGroups::partition() const {
  std::vector<std::uint32_t> number(group_of_row_.size(), none), map(group_of_row_.size());
  std::uint32_t groups = 0;
  for (std::uint32_t r = 0; r < map.size(); ++r) {
    std::uint32_t group = r;
    while (group_of_row_[group] != group) group = group_of_row_[group];
    if (number[group] == none) number[group] = groups++;
    map[r] = number[group];
  }
  return Partition::from_group_of_member(std::move(map));
}

void RowGroups::insert(std::uint32_t group) {
  place_[group] = static_cast<std::uint32_t>(alive_.size());
  alive_.push_back(group);
  auto& same = of_size_[size_[group]];
  place_in_size_[group] = static_cast<std::uint32_t>(same.size());
  same.push_back(group);
}

void RowGroups::remove(std::uint32_t group) {
  const auto take_out = [](std::vector<std::uint32_t>& list, std::vector<std::uint32_t>& places, std::uint32_t place) {
    list[place] = list.back();
    places[list[place]] = place;
    list.pop_back();
  };
  take_out(of_size_[size_[group]], place_in_size_, place_in_size_[group]);
  take_out(alive_, place_, place_[group]);
  place_[group] = none;
}

}  // namespace vismat
