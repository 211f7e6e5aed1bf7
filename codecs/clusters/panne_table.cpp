// ALGORITHM. The table of clusters. Every change is priced before it is made, by the numbers that it adds and removes.
// A new cluster's rank is one above those given away at its column, so that no other number changes. If a list that is
// itself a cluster changes, it must still reach as far as before; otherwise the zeros that follow it in other lists
// would change too.
#include "codecs/clusters/panne_table.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>
#include <utility>

namespace vismat {
namespace {

constexpr std::uint32_t nothing = 0xffffffff;

std::int64_t difference(std::uint64_t a, std::uint64_t b) {
  return static_cast<std::int64_t>(a) - static_cast<std::int64_t>(b);
}

}  // namespace

PanneTable::PanneTable(const VisibilityMatrix& matrix)
    : shape_(matrix.shape()), heads_(matrix.shape().columns, 0), prices_(PannePrices::Counts{}) {
  lists_.reserve(shape_.rows);
  for (std::uint32_t r = 0; r < shape_.rows; ++r)
    lists_.emplace_back(matrix.row(r).begin(), matrix.row(r).end());
  prices_ = PannePrices(counts());
  price_ = price_of_all();
}

// --- Prices ---------------------------------------------------------------------------------------------------------------

// Adds up what members cost, one after another.
class PanneTable::Pricer {
 public:
  Pricer(const PanneTable& table, std::uint32_t from) : table_(table), from_(from) {}
  void lead(std::uint32_t rank, std::uint32_t reach) {
    price_ += table_.prices_.of(PanneNumber::lead, rank + 1);
    from_ = reach;
  }
  void cluster(const NewCluster& cluster) {
    close();
    price_ += table_.prices_.of(PanneNumber::cluster_step, cluster.first - from_ + 1) +
              table_.prices_.of(PanneNumber::rank, cluster.rank);
    from_ = cluster.reach;
  }
  void member(std::uint32_t member) {
    if (!table_.is_object(member)) {
      const Cluster& it = table_.clusters_[member - table_.shape_.columns];
      return cluster({it.first, it.reach, it.rank});
    }
    if (run_ > 0 && member == from_) {
      ++run_;
    } else {
      close();
      step_ = member - from_ + 1;
      run_ = 1;
    }
    from_ = member + 1;
  }
  std::uint64_t price() {
    close();
    return price_;
  }

 private:
  void close() {
    if (run_ == 1) {
      price_ += table_.prices_.of(PanneNumber::object_step, step_);
    } else if (run_ > 1) {
      price_ +=
          table_.prices_.of(PanneNumber::run_step, step_) + table_.prices_.of(PanneNumber::run, run_ - 1);
    }
    run_ = 0;
  }
  const PanneTable& table_;
  std::uint32_t from_, step_ = 0, run_ = 0;  // where zeros are counted from; the run that is not priced yet
  std::uint64_t price_ = 0;
};

std::uint64_t PanneTable::list_price(std::span<const std::uint32_t> list, bool row) const {
  if (list.empty()) return 0;
  Pricer pricer(*this, 0);
  if (!row) {
    pricer.lead(rank(list[0]), reach(list[0]));
    list = list.subspan(1);
  }
  for (const std::uint32_t member : list) pricer.member(member);
  return pricer.price() + prices_.of(PanneNumber::end, 1);
}

// What one more cluster that begins here adds.
std::uint64_t PanneTable::head_price(std::uint32_t first) const {
  return prices_.of(PanneNumber::heads, heads_[first] + 2) -
         prices_.of(PanneNumber::heads, heads_[first] + 1);
}

std::uint64_t PanneTable::price_of_all() const {
  std::uint64_t price = 0;
  for (std::uint32_t l = 0; l < lists_.size(); ++l) price += list_price(lists_[l], is_row(l));
  for (const std::uint32_t clusters : heads_) price += prices_.of(PanneNumber::heads, clusters + 1);
  return price;
}

PannePrices::Counts PanneTable::counts() const {
  PannePrices::Counts counts{};
  const auto count = [&](PanneNumber kind, std::uint32_t number) {
    ++counts[static_cast<std::size_t>(kind)][symbol_of_length(number).symbol];
  };
  for (std::uint32_t l = 0; l < lists_.size(); ++l) for_each_number(l, count);
  for (const std::uint32_t clusters : heads_) count(PanneNumber::heads, clusters + 1);
  return counts;
}

std::uint32_t PanneTable::reach_of(std::span<const std::uint32_t> list) const {
  std::uint32_t to = reach(list[0]);
  for (std::size_t i = 1; i < list.size() && first(list[i]) == to; ++i) to = reach(list[i]);
  return to;
}

std::uint32_t PanneTable::add(List list, std::uint32_t near) {
  const std::uint32_t begin = first(list[0]), to = reach_of(list);
  clusters_.push_back({begin, to, ++heads_[begin], near});
  lists_.push_back(std::move(list));
  return shape_.columns + clusters() - 1;
}

// --- Equal columns ---------------------------------------------------------------------------------------------------------

bool PanneTable::group_equal_columns(const VisibilityMatrix& matrix) {
  assert(clusters_.empty());
  const VisibilityMatrix rows_of = transpose(matrix);
  std::vector<std::uint32_t> columns;
  for (std::uint32_t c = 0; c < shape_.columns; ++c) {
    if (rows_of.row(c).size() >= 2) columns.push_back(c);
  }
  const auto equal = [&](std::uint32_t a, std::uint32_t b) {
    return std::ranges::equal(rows_of.row(a), rows_of.row(b));
  };
  std::vector<std::uint64_t> hashes(shape_.columns, 0);
  for (const std::uint32_t c : columns) {
    for (const std::uint32_t r : rows_of.row(c)) hashes[c] = (hashes[c] ^ r) * 0x9e3779b97f4a7c15u;
  }
  std::stable_sort(columns.begin(), columns.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return hashes[a] < hashes[b]; });
  std::vector<List> groups;
  for (std::size_t begin = 0, end; begin < columns.size(); begin = end) {
    for (end = begin + 1; end < columns.size() && equal(columns[begin], columns[end]);) ++end;
    if (end - begin >= 2) groups.emplace_back(columns.begin() + begin, columns.begin() + end);
  }
  if (groups.empty()) return false;
  std::sort(groups.begin(), groups.end());
  PanneTable grouped = *this;
  std::vector<std::uint32_t> member_of(shape_.columns);
  std::iota(member_of.begin(), member_of.end(), 0);
  for (const List& group : groups) {
    for (const std::uint32_t c : group) member_of[c] = nothing;
    member_of[group[0]] = grouped.add(group, rows_of.row(group[0])[0]);
  }
  for (std::uint32_t r = 0; r < shape_.rows; ++r) {
    for (std::uint32_t& member : grouped.lists_[r]) member = member_of[member];
    std::erase(grouped.lists_[r], nothing);
  }
  grouped.prices_ = PannePrices(grouped.counts());
  grouped.price_ = grouped.price_of_all();
  *this = std::move(grouped);
  return true;
}

// --- A subset that two lists share --------------------------------------------------------------------------------------------

// Takes from `common` what would change how far the list reaches, if it is a cluster: of the members through which it
// does those behind one that is not common.
void PanneTable::keep_reach(std::uint32_t list, List& common) const {
  if (is_row(list) || common.empty()) return;
  const List& members = lists_[list];
  std::size_t met = 0, kept = 0;  // of the common ones
  bool broken = false;
  std::uint32_t to = first(members[0]);
  for (std::size_t i = 0; i < members.size() && first(members[i]) == to; to = reach(members[i++])) {
    if (met == common.size() || common[met] != members[i]) {
      broken = met > 0;
    } else {
      if (!broken) common[kept++] = common[met];
      ++met;
    }
  }
  common.erase(common.begin() + static_cast<std::ptrdiff_t>(kept),
               common.begin() + static_cast<std::ptrdiff_t>(met));
}

std::int64_t PanneTable::saved_by_sharing(std::uint32_t a, std::uint32_t b, List& common) const {
  const List& in_a = lists_[a];
  const List& in_b = lists_[b];
  common.clear();
  for (std::size_t i = 0, j = 0; i < in_a.size() && j < in_b.size();) {
    const std::uint32_t first_a = first(in_a[i]), first_b = first(in_b[j]);
    if (in_a[i] == in_b[j]) common.push_back(in_a[i]);
    i += first_a <= first_b;
    j += first_b <= first_a;
  }
  for (std::size_t size = 0; size != common.size();) {
    size = common.size();
    keep_reach(a, common);
    keep_reach(b, common);
  }
  if (common.size() < 2) return 0;
  const bool is_a = !is_row(a) && common.size() == in_a.size(),
             is_b = !is_row(b) && common.size() == in_b.size();
  if (is_a && is_b) return 0;
  const std::uint32_t begin = first(common[0]);
  NewCluster cluster{begin, 0, heads_[begin] + 1};
  if (is_a || is_b) {
    const std::uint32_t member = member_of_list(is_a ? a : b);
    cluster = {begin, reach(member), rank(member)};
  } else {
    cluster.reach = reach_of(common);
  }
  const auto price_with_it = [&](std::uint32_t l) {
    const List& list = lists_[l];
    Pricer pricer(*this, 0);
    std::size_t taken = 0, i = 0;
    if (!is_row(l)) {
      taken = list[0] == common[0];
      if (taken)
        pricer.lead(cluster.rank, cluster.reach);
      else
        pricer.lead(rank(list[0]), reach(list[0]));
      ++i;
    }
    for (; i < list.size(); ++i) {
      if (taken == common.size() || list[i] != common[taken])
        pricer.member(list[i]);
      else if (taken++ == 0)
        pricer.cluster(cluster);
    }
    return pricer.price() + prices_.of(PanneNumber::end, 1);
  };
  std::int64_t saved = 0;
  if (!is_a) saved += difference(list_price(in_a, is_row(a)), price_with_it(a));
  if (!is_b) saved += difference(list_price(in_b, is_row(b)), price_with_it(b));
  if (!is_a && !is_b) saved -= difference(list_price(common, false) + head_price(begin), 0);
  return saved;
}

bool PanneTable::share(std::uint32_t a, std::uint32_t b) {
  List common;
  const std::int64_t saved = saved_by_sharing(a, b, common);
  if (saved <= 0) return false;
  const bool is_a = !is_row(a) && common.size() == lists_[a].size(),
             is_b = !is_row(b) && common.size() == lists_[b].size();
  const std::uint32_t member =
      is_a || is_b ? member_of_list(is_a ? a : b) : add(common, std::min(row_near(a), row_near(b)));
  for (const std::uint32_t l : {a, b}) {
    if (l == (is_a ? a : is_b ? b : nothing)) continue;
    std::size_t taken = 0;
    for (std::uint32_t& s : lists_[l]) {
      if (taken == common.size() || s != common[taken]) continue;
      s = taken++ == 0 ? member : nothing;
    }
    std::erase(lists_[l], nothing);
  }
  price_ -= static_cast<std::uint64_t>(saved);
  return true;
}

// --- Two members that many lists hold -----------------------------------------------------------------------------------------

std::size_t PanneTable::place_of(std::uint32_t list, std::uint32_t member) const {
  const List& members = lists_[list];
  const std::uint32_t begin = first(member);
  return static_cast<std::size_t>(
      std::lower_bound(members.begin(), members.end(), begin,
                       [this](std::uint32_t s, std::uint32_t f) { return first(s) < f; }) -
      members.begin());
}

PanneTable::Joined PanneTable::joined(std::uint32_t x, std::uint32_t y,
                                      std::span<const std::uint32_t> both) const {
  for (const std::uint32_t l : both) {
    if (is_row(l) || lists_[l].size() != 2) continue;
    const std::uint32_t member = member_of_list(l);
    return {{first(member), reach(member), rank(member)}, true, member};
  }
  const std::uint32_t begin = first(x);
  return {{begin, first(y) == reach(x) ? reach(y) : reach(x), heads_[begin] + 1}, false, 0};
}

// Whether the member at this place goes on a run of objects.
inline bool PanneTable::follows(const List& list, std::size_t place) const {
  return place > 0 && is_object(list[place]) && list[place] == list[place - 1] + 1;
}

std::int64_t PanneTable::saved_in(std::uint32_t l, std::uint32_t x, std::uint32_t y,
                                  const NewCluster& cluster) const {
  const List& list = lists_[l];
  const bool row = is_row(l);
  if (!row && list.size() == 2) return 0;  // the cluster itself, or its like
  const std::size_t i = place_of(l, x), j = place_of(l, y);
  const auto begin_of = [&](std::size_t place) {
    while (place > (row ? 0u : 1u) && follows(list, place)) --place;
    return place;
  };
  const auto end_of = [&](std::size_t place) {
    do ++place;
    while (place < list.size() && follows(list, place));
    return place;
  };
  // An object within a long run is not worth a look: the run would become two.
  constexpr std::size_t far = 16;
  for (const std::size_t place : {i, j}) {
    if (place >= far && place + far < list.size() && is_object(list[place]) &&
        list[place + far] == list[place - far] + 2 * far)
      return 0;
  }
  if (!row && j > i + 1) {  // y must not be what the list reaches on through
    std::size_t k = j;
    while (k > 0 && first(list[k]) == reach(list[k - 1])) --k;
    if (k == 0) return 0;
  }
  // Both are priced with the runs that they stand in and what comes behind; the rest stays as it is.
  const auto saved_between = [&](std::size_t begin, std::size_t end) {
    Pricer before(*this, begin == 0 ? 0 : reach(list[begin - 1])), after = before;
    std::size_t k = begin;
    if (k == 0 && !row) {
      before.lead(rank(list[0]), reach(list[0]));
      if (i == 0)
        after.lead(cluster.rank, cluster.reach);
      else
        after.lead(rank(list[0]), reach(list[0]));
      ++k;
    }
    for (; k < end; ++k) {
      before.member(list[k]);
      if (k == i)
        after.cluster(cluster);
      else if (k != j)
        after.member(list[k]);
    }
    return difference(before.price(), after.price());
  };
  const std::size_t begin_x = begin_of(i), end_x = end_of(i), begin_y = begin_of(j);
  std::size_t end_y = end_of(j);
  if (end_y < list.size()) end_y = end_of(end_y);
  if (begin_y <= end_x) return saved_between(begin_x, end_y);
  return saved_between(begin_x, std::min(end_of(end_x), begin_y)) + saved_between(begin_y, end_y);
}

std::int64_t PanneTable::saved_by_joining(std::uint32_t x, std::uint32_t y,
                                          std::span<const std::uint32_t> both) const {
  const Joined it = joined(x, y, both);
  std::int64_t saved = 0;
  for (const std::uint32_t l : both) saved += std::max<std::int64_t>(0, saved_in(l, x, y, it.cluster));
  if (saved > 0 && !it.exists) {
    const std::array<std::uint32_t, 2> content = {x, y};
    saved -= difference(list_price(content, false) + head_price(it.cluster.first), 0);
  }
  return saved;
}

bool PanneTable::join(std::uint32_t x, std::uint32_t y, std::span<const std::uint32_t> both) {
  const std::int64_t saved = saved_by_joining(x, y, both);
  if (saved <= 0) return false;
  const Joined it = joined(x, y, both);
  std::vector<std::uint32_t> where;
  for (const std::uint32_t l : both) {
    if (saved_in(l, x, y, it.cluster) > 0) where.push_back(l);
  }
  const std::uint32_t member = it.exists ? it.member : add({x, y}, row_near(where[0]));
  for (const std::uint32_t l : where) {
    lists_[l][place_of(l, x)] = member;
    lists_[l].erase(lists_[l].begin() + static_cast<std::ptrdiff_t>(place_of(l, y)));
  }
  price_ -= static_cast<std::uint64_t>(saved);
  return true;
}

// --- Tidying up ---------------------------------------------------------------------------------------------------------------

std::uint32_t PanneTable::dissolve() {
  std::vector<std::uint32_t> uses(clusters_.size(), 0), user(clusters_.size(), 0);
  for (std::uint32_t l = 0; l < lists_.size(); ++l) {
    for (const std::uint32_t member : lists_[l]) {
      if (is_object(member)) continue;
      ++uses[member - shape_.columns];
      user[member - shape_.columns] = l;
    }
  }
  std::uint32_t gone = 0;
  // The last made first: what holds a cluster was mostly made after it.
  for (std::uint32_t v = clusters(); v-- > 0;) {
    const std::uint32_t member = shape_.columns + v, own = shape_.rows + v;
    List& content = lists_[own];
    if (content.empty() || uses[v] > 1) continue;
    std::uint64_t saved = list_price(content, false);
    if (uses[v] == 1) {
      const std::uint32_t l = user[v];
      List merged;
      merged.reserve(lists_[l].size() + content.size());
      std::size_t next = 0;
      for (const std::uint32_t s : lists_[l]) {
        for (; next < content.size() && first(content[next]) < first(s); ++next)
          merged.push_back(content[next]);
        if (s != member) merged.push_back(s);
      }
      merged.insert(merged.end(), content.begin() + static_cast<std::ptrdiff_t>(next), content.end());
      saved += list_price(lists_[l], is_row(l));
      const std::uint64_t more = list_price(merged, is_row(l));
      if (saved <= more || (!is_row(l) && reach_of(merged) != reach(member_of_list(l)))) continue;
      saved -= more;
      lists_[l] = std::move(merged);
      for (const std::uint32_t s : content) {
        if (!is_object(s)) user[s - shape_.columns] = l;
      }
    } else {
      for (const std::uint32_t s : content) {
        if (is_object(s)) continue;
        --uses[s - shape_.columns];
        // Who the last user is, is not known then: it waits for the next call.
        if (uses[s - shape_.columns] == 1) uses[s - shape_.columns] = 2;
      }
    }
    content = {};
    price_ -= saved;
    ++gone;
  }
  return gone;
}

void PanneTable::loosen(const std::vector<bool>& chosen) {
  const auto goes = [&](std::uint32_t member) {
    return !is_object(member) && chosen[member - shape_.columns];
  };
  List loose, open;
  for (std::uint32_t l = 0; l < lists_.size(); ++l) {
    if (std::none_of(lists_[l].begin(), lists_[l].end(), goes)) continue;
    loose.clear();
    open = lists_[l];
    while (!open.empty()) {
      const std::uint32_t member = open.back();
      open.pop_back();
      if (!goes(member)) {
        loose.push_back(member);
        continue;
      }
      const List& content = lists_[list_of_member(member)];
      open.insert(open.end(), content.begin(), content.end());
    }
    std::sort(loose.begin(), loose.end(),
              [this](std::uint32_t a, std::uint32_t b) { return first(a) < first(b); });
    if (is_row(l) || reach_of(loose) == reach(member_of_list(l))) lists_[l] = loose;
  }
  price_ = price_of_all();
}

bool PanneTable::settle() {
  std::vector<std::uint32_t> uses(clusters_.size(), 0), by_uses(clusters_.size());
  for (const List& list : lists_) {
    for (const std::uint32_t member : list) {
      if (!is_object(member)) ++uses[member - shape_.columns];
    }
  }
  std::iota(by_uses.begin(), by_uses.end(), 0);
  std::stable_sort(by_uses.begin(), by_uses.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return uses[a] > uses[b]; });
  const auto clusters_before = clusters_;
  const auto heads_before = heads_;
  const PannePrices prices_before = prices_;
  std::fill(heads_.begin(), heads_.end(), 0);
  for (const std::uint32_t v : by_uses) {
    if (!lists_[shape_.rows + v].empty()) clusters_[v].rank = ++heads_[clusters_[v].first];
  }
  prices_ = PannePrices(counts());
  const std::uint64_t price = price_of_all();
  if (price < price_) {
    price_ = price;
    return true;
  }
  clusters_ = clusters_before;
  heads_ = heads_before;
  prices_ = prices_before;
  return false;
}

void PanneTable::close_ranks() {
  std::vector<std::uint32_t> by_rank(clusters_.size());
  std::iota(by_rank.begin(), by_rank.end(), 0);
  std::stable_sort(by_rank.begin(), by_rank.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return clusters_[a].rank < clusters_[b].rank; });
  std::fill(heads_.begin(), heads_.end(), 0);
  for (const std::uint32_t v : by_rank) {
    if (!lists_[shape_.rows + v].empty()) clusters_[v].rank = ++heads_[clusters_[v].first];
  }
  price_ = price_of_all();
}

PanneTable::List PanneTable::expand(std::uint32_t list) const {
  List objects, open(lists_[list]);
  while (!open.empty()) {
    const std::uint32_t member = open.back();
    open.pop_back();
    if (is_object(member))
      objects.push_back(member);
    else
      open.insert(open.end(), lists_[list_of_member(member)].begin(), lists_[list_of_member(member)].end());
  }
  std::sort(objects.begin(), objects.end());
  return objects;
}

}  // namespace vismat
