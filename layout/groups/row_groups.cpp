#include "layout/groups/row_groups.h"

#include <algorithm>
#include <cstdlib>
#include <numeric>
#include <optional>
#include <utility>

namespace vismat {
namespace {

constexpr std::uint32_t most_in_16_bits = 0xffff;

void take_out(std::vector<std::uint32_t>& list, std::vector<std::uint32_t>& places, std::uint32_t place) {
  list[place] = list.back();
  places[list[place]] = place;
  list.pop_back();
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

RowGroups::RowGroups(const VisibilityMatrix& matrix, const GroupingOptions& options,
                     std::optional<GroupSets::Form> form)
    : kind_of_row_(equal_rows(matrix)),
      kinds_(merge_rows(matrix, kind_of_row_)),
      rows_of_kind_(kinds_.shape().rows, 0),
      room_(options.room_in_column),
      sets_(kinds_, form.value_or(GroupSets::cheaper(kinds_))),
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
  }
  most_of_kind_ = most_;
}

std::uint64_t RowGroups::score(std::uint32_t a, std::uint32_t b, std::uint64_t limit) const {
  const Lost lost(rows_[a], size_[a], rows_[b], size_[b]);
  const auto far = lost.farthest(limit);
  if (!far) return unbounded;
  const std::uint32_t distance = sets_.distance(a, b, *far);
  if (distance > *far || lost.union_at(distance) > std::min(most_[a], most_[b])) return unbounded;
  return has_room(a, b) ? lost.at(distance) : unbounded;
}

// The least few pairs, without repeats.
class RowGroups::Best {
 public:
  explicit Best(std::uint32_t most) : most_(most) {}
  /// A pair above this is not among them.
  Pair limit() const { return pairs_.size() < most_ ? Pair{} : pairs_.back(); }
  void offer(const Pair& pair) {
    if (pair >= limit()) return;
    const auto at = std::ranges::lower_bound(pairs_, pair);
    if (at != pairs_.end() && *at == pair) return;
    pairs_.insert(at, pair);
    if (pairs_.size() > most_) pairs_.pop_back();
  }
  std::vector<Pair> take() { return std::move(pairs_); }

 private:
  std::uint32_t most_;
  std::vector<Pair> pairs_;
};

std::vector<RowGroups::Pair> RowGroups::best_partners(std::uint32_t group, std::uint32_t most,
                                                      unsigned threads) const {
  Best best(most);
  if (!sets_.listed())
    search_by_size(group, best);
  else if (!sets_.indexed())
    search_among(group, alive_, best);
  else if (size_[group] <= most_in_16_bits)
    search_by_index<std::uint16_t>(group, best, threads);
  else
    search_by_index<std::uint32_t>(group, best, threads);
  return best.take();
}

// Only groups of similar size are examined [Zach & Karner 2003, section 4.1]. Groups of near rows come first, as near
// rows are often similar, and a low score soon rules the others out.
void RowGroups::search_by_size(std::uint32_t group, Best& best) const {
  const auto look_at = [&](std::uint32_t other) {
    if (other == group) return;
    const std::uint64_t score = this->score(group, other, best.limit().score);
    if (score != unbounded) best.offer({score, other});
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
    smaller = smaller && away <= own && away <= best.limit().score;
    larger = larger && away <= columns - own && std::uint64_t{away} * rows_[group] <= best.limit().score &&
             own + away <= most_[group];
    if (smaller) look_at_size(own - away);
    if (larger) look_at_size(own + away);
  }
}

// `shared` is how many columns the two have in common.
void RowGroups::look_at(std::uint32_t group, std::uint32_t other, std::uint64_t shared, Best& best) const {
  const std::uint64_t alone = size_[other] - shared;
  const Pair pair = {rows_[group] * alone + rows_[other] * (size_[group] - shared), other};
  if (pair >= best.limit() || other == group) return;
  if (size_[group] + alone <= std::min(most_[group], most_[other]) && has_room(group, other))
    best.offer(pair);
}

template <typename Count>
void RowGroups::search_by_index(std::uint32_t group, Best& best, unsigned threads) const {
  const std::vector<Count> common = sets_.common<Count>(sets_.list(group), threads);
  for (const std::uint32_t other : alive_) look_at(group, other, common[sets_.slot(other)], best);
}

void RowGroups::search_among(std::uint32_t group, std::span<const std::uint32_t> others, Best& best) const {
  const std::vector<std::uint32_t> common = sets_.common_with(group, others);
  for (std::size_t i = 0; i < others.size(); ++i) look_at(group, others[i], common[i], best);
}

std::vector<RowGroups::Pair> RowGroups::best_among(std::uint32_t group, std::span<const std::uint32_t> kinds,
                                                   std::uint32_t most) const {
  std::vector<std::uint32_t> others;
  for (const std::uint32_t kind : kinds) others.push_back(group_of_kind_[kind]);
  std::ranges::sort(others);
  others.erase(std::unique(others.begin(), others.end()), others.end());
  Best best(most);
  search_among(group, others, best);
  return best.take();
}

void RowGroups::merge(std::uint32_t into, std::uint32_t from) {
  lost_ += score(into, from);
  take_room(into, from);
  sets_.join(into, from);
  set_size(into, sets_.size(into));
  rows_[into] += rows_[from];
  most_[into] = std::min(most_[into], most_[from]);
  for (const std::uint32_t kind : members_[from]) group_of_kind_[kind] = into;
  members_[into].insert(members_[into].end(), members_[from].begin(), members_[from].end());
  members_[from].clear();
  take_out(of_size_[size_[from]], place_in_size_, place_in_size_[from]);
  take_out(alive_, place_, place_[from]);
  place_[from] = none;
}

// The group where the kind would lose least, less than what is regained where it is.
RowGroups::Pair RowGroups::best_home(std::uint32_t kind, std::uint64_t regained) const {
  const auto ids = kinds_.row(kind);
  const auto ones = static_cast<std::uint32_t>(ids.size());
  if (!sets_.listed()) {
    BitRows own({1, kinds_.shape().columns});
    for (const std::uint32_t c : ids) own.set(0, c);
    return best_home(kind, regained, [&](std::uint32_t to, std::uint32_t limit) {
      return sets_.distance(std::as_const(own).row(0), to, limit);
    });
  }
  const auto by_index = [&](const auto& common) {
    return best_home(kind, regained, [&](std::uint32_t to, std::uint32_t) {
      return ones + size_[to] - 2 * std::uint32_t{common[sets_.slot(to)]};
    });
  };
  return ones <= most_in_16_bits ? by_index(sets_.common<std::uint16_t>(ids))
                                 : by_index(sets_.common<std::uint32_t>(ids));
}

template <typename DistanceTo>
RowGroups::Pair RowGroups::best_home(std::uint32_t kind, std::uint64_t regained,
                                     const DistanceTo& distance_to) const {
  const auto ids = kinds_.row(kind);
  Pair best = {regained - 1, none};
  for (const std::uint32_t to : alive_) {
    if (to == group_of_kind_[kind]) continue;
    const Lost lost(rows_of_kind_[kind], static_cast<std::int64_t>(ids.size()), rows_[to], size_[to]);
    const auto far = lost.farthest(best.score);
    if (!far) continue;
    const std::uint32_t distance = distance_to(to, *far);
    if (distance > *far || lost.union_at(distance) > std::min(most_of_kind_[kind], most_[to])) continue;
    const Pair pair = {lost.at(distance), to};
    if (pair > best) continue;
    bool room = true;
    if (!room_.empty()) {
      sets_.each_difference(ids, to, [&](std::uint32_t c, bool in_kind_alone) {
        room = room && room_[c] >= (in_kind_alone ? rows_[to] : rows_of_kind_[kind]);
      });
    }
    if (room) best = pair;
  }
  return best;
}

std::uint64_t RowGroups::exchange() {
  sets_.begin_moves(alive_, group_of_kind_);
  const std::uint64_t lost_before = lost_;
  for (std::uint32_t k = 0; k < kinds_.shape().rows; ++k) {
    const std::uint32_t from = group_of_kind_[k], in_kind = rows_of_kind_[k];
    if (members_[from].size() == 1) continue;
    const auto ids = kinds_.row(k);
    const auto ones = static_cast<std::uint32_t>(ids.size());
    const std::uint64_t regained = std::uint64_t{rows_[from] - in_kind} * sets_.alone(k, from) +
                                   std::uint64_t{in_kind} * (size_[from] - ones);
    if (regained == 0) continue;
    const Pair home = best_home(k, regained);
    const std::uint32_t to = home.partner;
    if (to == none) continue;

    lost_ -= regained - home.score;
    if (!room_.empty()) {
      sets_.each_difference(ids, to, [&](std::uint32_t c, bool in_kind_alone) {
        room_[c] -= in_kind_alone ? rows_[to] : in_kind;
      });
    }
    sets_.move(k, from, to);
    rows_[from] -= in_kind;
    rows_[to] += in_kind;
    set_size(from, sets_.size(from));
    set_size(to, sets_.size(to));
    if (!room_.empty()) {  // what the two no longer lose to one another
      sets_.each_difference(ids, from, [&](std::uint32_t c, bool in_kind_alone) {
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
  sets_.end_moves();
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
bool RowGroups::has_room(std::uint32_t a, std::uint32_t b) const {
  bool room = true;
  if (!room_.empty()) {
    sets_.each_difference(
        a, b, [&](std::uint32_t c, bool of_a) { room = room && room_[c] >= (of_a ? rows_[b] : rows_[a]); });
  }
  return room;
}

void RowGroups::take_room(std::uint32_t a, std::uint32_t b) {
  if (room_.empty()) return;
  sets_.each_difference(a, b, [&](std::uint32_t c, bool of_a) { room_[c] -= of_a ? rows_[b] : rows_[a]; });
}

void RowGroups::set_size(std::uint32_t group, std::uint32_t size) {
  take_out(of_size_[size_[group]], place_in_size_, place_in_size_[group]);
  size_[group] = size;
  place_in_size_[group] = static_cast<std::uint32_t>(of_size_[size].size());
  of_size_[size].push_back(group);
}

}  // namespace vismat
