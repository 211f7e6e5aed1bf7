#include "layout/groups/row_groups.h"

#include <algorithm>
#include <bit>
#include <cstdlib>
#include <numeric>
#include <optional>
#include <utility>

namespace vismat {
namespace {

constexpr std::uint32_t folded_bits = 512;

void take_out(std::vector<std::uint32_t>& list, std::vector<std::uint32_t>& places, std::uint32_t place) {
  list[place] = list.back();
  places[list[place]] = place;
  list.pop_back();
}

// Calls visit(column, in_a) for each column that only one of the two has.
template <typename Visit>
void for_each_difference(std::span<const std::uint64_t> a, std::span<const std::uint64_t> b,
                         const Visit& visit) {
  for (std::size_t w = 0; w < a.size(); ++w) {
    for (std::uint64_t differ = a[w] ^ b[w]; differ != 0; differ &= differ - 1) {
      const auto bit = static_cast<unsigned>(std::countr_zero(differ));
      visit(64 * w + bit, (a[w] >> bit & 1) != 0);
    }
  }
}

}  // namespace

// Two rows, or unions of rows, that are to be in one group, each as often as there are rows: with distance d the first has
// (d + more) / 2 columns alone and the second (d - more) / 2, so (d (in_a + in_b) - more (in_a - in_b)) / 2 occlusions are
// lost, and a bound on these is one on d.
struct RowGroups::Lost {
  std::int64_t in_both, more, ones, uneven;
  Lost(std::int64_t in_a, std::int64_t ones_of_a, std::int64_t in_b, std::int64_t ones_of_b)
      : in_both(in_a + in_b),
        more(ones_of_a - ones_of_b),
        ones(ones_of_a + ones_of_b),
        uneven(more * (in_a - in_b)) {}
  /// The greatest distance at which at most `limit` are lost; none if the sizes alone rule it out.
  std::optional<std::uint32_t> farthest(std::uint64_t limit) const {
    if (limit == unbounded) return static_cast<std::uint32_t>(ones);
    const std::int64_t twice = 2 * static_cast<std::int64_t>(limit) + uneven;
    if (twice < std::abs(more) * in_both) return std::nullopt;
    return static_cast<std::uint32_t>(std::min(ones, twice / in_both));
  }
  std::uint64_t at(std::uint32_t distance) const {
    return static_cast<std::uint64_t>(distance * in_both - uneven) / 2;
  }
  std::int64_t union_at(std::uint32_t distance) const { return (ones + distance) / 2; }
};

RowGroups::RowGroups(const VisibilityMatrix& matrix, const GroupingOptions& options)
    : kind_of_row_(equal_rows(matrix)),
      kinds_(merge_rows(matrix, kind_of_row_)),
      rows_of_kind_(kinds_.shape().rows, 0),
      room_(options.room_in_column),
      union_(kinds_),
      folded_({kinds_.shape().rows, std::min(folded_bits, kinds_.shape().columns)}),
      of_size_(kinds_.shape().columns + std::size_t{1}),
      place_in_size_(kinds_.shape().rows) {
  const auto [kinds, columns] = kinds_.shape();
  for (const std::uint32_t kind : kind_of_row_.group_of_member()) ++rows_of_kind_[kind];
  rows_ = rows_of_kind_;
  alive_.resize(kinds);
  std::iota(alive_.begin(), alive_.end(), 0u);
  place_ = group_of_kind_ = alive_;
  for (std::uint32_t k = 0; k < kinds; ++k) {
    const auto ones = static_cast<std::uint32_t>(kinds_.row(k).size());
    size_.push_back(ones);
    most_.push_back(ones + static_cast<std::uint32_t>(options.lost_in_row * (columns - ones)));
    members_.push_back({k});
    place_in_size_[k] = static_cast<std::uint32_t>(of_size_[ones].size());
    of_size_[ones].push_back(k);
    fold(k);
  }
  most_of_kind_ = most_;
}

std::uint64_t RowGroups::score(std::uint32_t a, std::uint32_t b, std::uint64_t limit) const {
  const Lost lost(rows_[a], size_[a], rows_[b], size_[b]);
  const auto far = lost.farthest(limit);
  if (!far || hamming_distance(folded_.row(a), folded_.row(b), *far) > *far) return unbounded;
  const std::uint32_t distance = hamming_distance(union_.row(a), union_.row(b), *far);
  if (distance > *far || lost.union_at(distance) > std::min(most_[a], most_[b])) return unbounded;
  return has_room(union_.row(a), rows_[a], union_.row(b), rows_[b]) ? lost.at(distance) : unbounded;
}

RowGroups::Pair RowGroups::best_partner(std::uint32_t group) const {
  Pair best;
  const auto look_at = [&](std::uint32_t other) {
    if (other == group) return;
    const std::uint64_t score = this->score(group, other, best.score);
    if (score < best.score || (score == best.score && score != unbounded && other < best.partner))
      best = {score, other};
  };
  const auto kinds = static_cast<std::uint32_t>(group_of_kind_.size());
  for (std::uint32_t away = 1; away < kinds; away *= 2) {
    if (away <= group) look_at(group_of_kind_[group - away]);
    if (away < kinds - group) look_at(group_of_kind_[group + away]);
  }
  const auto look_at_size = [&](std::uint32_t size) {
    for (const std::uint32_t other : of_size_[size]) look_at(other);
  };
  const std::uint32_t own = size_[group], columns = kinds_.shape().columns;
  look_at_size(own);
  bool smaller = true, larger = true;
  for (std::uint32_t away = 1; smaller || larger; ++away) {
    smaller = smaller && away <= own && away <= best.score;
    larger = larger && away <= columns - own && std::uint64_t{away} * rows_[group] <= best.score &&
             own + away <= most_[group];
    if (smaller) look_at_size(own - away);
    if (larger) look_at_size(own + away);
  }
  return best;
}

void RowGroups::merge(std::uint32_t into, std::uint32_t from) {
  lost_ += score(into, from);
  take_room(union_.row(into), rows_[into], union_.row(from), rows_[from]);
  const auto whole = union_.row(into);
  std::uint32_t size = 0;
  for (std::size_t w = 0; w < whole.size(); ++w) {
    whole[w] |= std::as_const(union_).row(from)[w];
    size += static_cast<std::uint32_t>(std::popcount(whole[w]));
  }
  set_size(into, size);
  fold(into);
  rows_[into] += rows_[from];
  most_[into] = std::min(most_[into], most_[from]);
  for (const std::uint32_t kind : members_[from]) group_of_kind_[kind] = into;
  members_[into].insert(members_[into].end(), members_[from].begin(), members_[from].end());
  members_[from].clear();
  take_out(of_size_[size_[from]], place_in_size_, place_in_size_[from]);
  take_out(alive_, place_, place_[from]);
  place_[from] = none;
}

std::uint64_t RowGroups::exchange() {
  const std::size_t columns = kinds_.shape().columns;
  std::vector<std::uint32_t> seen(alive_.size() * columns, 0);  // by how many kinds of a group, by its place
  for (std::uint32_t k = 0; k < kinds_.shape().rows; ++k) {
    for (const std::uint32_t c : kinds_.row(k)) ++seen[place_[group_of_kind_[k]] * columns + c];
  }
  BitRows own({1, kinds_.shape().columns});
  const std::uint64_t lost_before = lost_;
  for (std::uint32_t k = 0; k < kinds_.shape().rows; ++k) {
    const std::uint32_t from = group_of_kind_[k], in_kind = rows_of_kind_[k];
    if (members_[from].size() == 1) continue;
    const auto ids = kinds_.row(k);
    const auto ones = static_cast<std::uint32_t>(ids.size());
    std::uint32_t* const seen_from = seen.data() + place_[from] * columns;
    const auto alone = static_cast<std::uint32_t>(
        std::count_if(ids.begin(), ids.end(), [&](std::uint32_t c) { return seen_from[c] == 1; }));
    const std::uint64_t regained =
        std::uint64_t{rows_[from] - in_kind} * alone + std::uint64_t{in_kind} * (size_[from] - ones);
    if (regained == 0) continue;

    std::ranges::fill(own.row(0), 0);
    for (const std::uint32_t c : ids) own.set(0, c);
    const auto bits = std::as_const(own).row(0);
    Pair best = {regained - 1, none};  // a move must gain
    for (const std::uint32_t to : alive_) {
      if (to == from) continue;
      const Lost lost(in_kind, ones, rows_[to], size_[to]);
      const auto far = lost.farthest(best.score);
      if (!far) continue;
      const std::uint32_t distance = hamming_distance(bits, union_.row(to), *far);
      if (distance > *far || lost.union_at(distance) > std::min(most_of_kind_[k], most_[to])) continue;
      const std::uint64_t score = lost.at(distance);
      if ((score < best.score || best.partner == none || to < best.partner) &&
          has_room(bits, in_kind, union_.row(to), rows_[to]))
        best = {score, to};
    }
    if (best.partner == none) continue;

    const std::uint32_t to = best.partner;
    lost_ -= regained - best.score;
    take_room(bits, in_kind, union_.row(to), rows_[to]);
    std::uint32_t* const seen_to = seen.data() + place_[to] * columns;
    std::uint32_t joining = 0;
    for (const std::uint32_t c : ids) {
      joining += seen_to[c]++ == 0;
      union_.set(to, c);
      if (--seen_from[c] == 0) union_.row(from)[c / 64] &= ~(std::uint64_t{1} << (c % 64));
    }
    rows_[from] -= in_kind;
    rows_[to] += in_kind;
    set_size(from, size_[from] - alone);
    set_size(to, size_[to] + joining);
    fold(from);
    fold(to);
    if (!room_.empty()) {  // what the two no longer lose to one another
      for_each_difference(bits, union_.row(from), [&](std::size_t c, bool in_kind_alone) {
        room_[c] += in_kind_alone ? rows_[from] : in_kind;
      });
    }
    group_of_kind_[k] = to;
    std::erase(members_[from], k);
    members_[to].push_back(k);
    most_[to] = std::min(most_[to], most_of_kind_[k]);
    most_[from] = none;
    for (const std::uint32_t member : members_[from])
      most_[from] = std::min(most_[from], most_of_kind_[member]);
  }
  return lost_before - lost_;
}

Partition RowGroups::partition() const {
  std::vector<std::uint32_t> number(group_of_kind_.size(), none), map(group_of_kind_.size());
  std::uint32_t groups = 0;
  for (std::uint32_t k = 0; k < map.size(); ++k) {
    const std::uint32_t group = group_of_kind_[k];
    if (number[group] == none) number[group] = groups++;
    map[k] = number[group];
  }
  return followed_by(kind_of_row_, Partition::from_group_of_member(std::move(map)));
}

// A column that a alone has is lost in the rows of b.
bool RowGroups::has_room(std::span<const std::uint64_t> a, std::uint64_t in_a,
                         std::span<const std::uint64_t> b, std::uint64_t in_b) const {
  bool room = true;
  if (!room_.empty())
    for_each_difference(a, b,
                        [&](std::size_t c, bool of_a) { room = room && room_[c] >= (of_a ? in_b : in_a); });
  return room;
}

void RowGroups::take_room(std::span<const std::uint64_t> a, std::uint64_t in_a,
                          std::span<const std::uint64_t> b, std::uint64_t in_b) {
  if (room_.empty()) return;
  for_each_difference(
      a, b, [&](std::size_t c, bool of_a) { room_[c] -= static_cast<std::uint32_t>(of_a ? in_b : in_a); });
}

void RowGroups::set_size(std::uint32_t group, std::uint32_t size) {
  take_out(of_size_[size_[group]], place_in_size_, place_in_size_[group]);
  size_[group] = size;
  place_in_size_[group] = static_cast<std::uint32_t>(of_size_[size].size());
  of_size_[size].push_back(group);
}

void RowGroups::fold(std::uint32_t group) {
  const auto words = std::as_const(union_).row(group);
  const auto folded = folded_.row(group);
  std::ranges::fill(folded, 0);
  for (std::size_t w = 0; w < words.size(); ++w) folded[w % folded.size()] ^= words[w];
}

}  // namespace vismat
