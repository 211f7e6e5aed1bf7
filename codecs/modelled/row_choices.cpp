#include "codecs/modelled/row_choices.h"

#include <algorithm>
#include <numeric>

#include "matrix/base/parallel.h"
#include "matrix/points/inverted_index.h"

namespace vismat {
namespace {

// The run ends that only one of two rows has.
std::vector<std::uint32_t> changes_between(Ends a, Ends b) {
  std::vector<std::uint32_t> only;
  std::set_symmetric_difference(a.at, a.at + a.count, b.at, b.at + b.count, std::back_inserter(only));
  return only;
}

// How much changes from a row to a second one, of which some are right, tell about those to another: 4 for each that is right, -1
// for each that is wrong.
int likeness(int right, int changes) {
  return 5 * right - changes;
}
int likeness(Ends a, Ends b, const std::vector<std::uint32_t>& changes) {
  int right = 0, all = 0;
  auto next = changes.begin();
  const std::uint32_t *at_a = a.at, *at_b = b.at;
  const std::uint32_t *const end_a = at_a + a.count, *const end_b = at_b + b.count;
  while (at_a != end_a || at_b != end_b) {  // sentinels end both
    const std::uint32_t column = std::min(*at_a, *at_b);
    const bool in_a = *at_a == column, in_b = *at_b == column;
    at_a += in_a;
    at_b += in_b;
    if (in_a == in_b) continue;
    while (next != changes.end() && *next < column) ++next;
    right += next != changes.end() && *next == column;
    ++all;
  }
  return likeness(right, all);
}

// ---- references ------------------------------------------------------------------------------------------------------

// The numbers of groups by how many groups they are in.
std::vector<std::vector<std::uint32_t>> levels_of(const std::vector<Group>& groups) {
  std::vector<std::vector<std::uint32_t>> levels;
  std::vector<std::uint32_t> level(groups.size());
  for (std::uint32_t g = 0; g < groups.size(); ++g) {
    if (groups[g].above != Group::none) level[g] = level[groups[g].above] + 1;
    if (level[g] == levels.size()) levels.emplace_back();
    levels[level[g]].push_back(g);
  }
  return levels;
}

// Second references; and first ones among the rows of the same group, which cost no time.
class ReferenceChoice {
 public:
  ReferenceChoice(CodedRows& rows, const RowLimits& limits, unsigned threads) : rows_(rows), limits_(limits) {
    const std::uint32_t count = rows.ends.rows(), kept = rows.plan.kept;
    rows.second.assign(count, 0);
    const std::vector<std::uint32_t> as_planned = rows.plan.reference;
    longest_ = limits.microseconds;
    if (kept == 0) {
      double sum = 0;
      for (std::uint32_t r = 0; r < count; ++r) sum += cost(r, rows.reference(r), own(r)).microseconds;
      longest_ = std::min(longest_, limits.mean_rows * sum / count);
    }
    kept_ends_ = InvertedIndex(kept, rows.ends.columns(),
                               [&](std::uint32_t r) { return std::span(rows.row(r).at, rows.row(r).count); });
    std::int64_t saved = 0;  // units, by naming
    for (std::uint32_t r = 0; r < kept; ++r) saved += choose(r, nullptr, Stands::kept, {}, r, 0).saved;
    std::vector<double> taken(count);  // the time of a row and of all that it takes
    std::vector<std::int64_t> saved_by(rows.groups.size());
    // A group waits for those above it alone.
    for (const std::vector<std::uint32_t>& level : levels_of(rows.groups)) {
      parallel_for(level.size(), threads, [&](std::uint64_t i) {
        const Group& group = rows.groups[level[i]];
        double now = group.outside <= kept ? 0 : taken[group.outside - 1];
        for (std::uint32_t place = 0; place < group.size; ++place) {
          const std::uint32_t r = group.first + place;
          const Chosen chosen = choose(r, &group, stands_at(place), rows.way_to(group, r), kept, now);
          taken[r] = now += chosen.time;
          saved_by[level[i]] += chosen.saved;
        }
      });
    }
    rows.names_second = std::accumulate(saved_by.begin(), saved_by.end(), saved) > 0;
    if (rows.names_second) return;
    rows.second.assign(count, 0);
    rows.plan.reference = as_planned;
  }

 private:
  std::uint32_t own(std::uint32_t r) const { return rows_.reference_of_number(rows_.reference(r)); }
  RowCost cost(std::uint32_t r, std::uint32_t a, std::uint32_t b) const {
    return cost_of_row(rows_.of_number(a), rows_.of_number(b), rows_.row(r), rows_.ends.columns(),
                       *limits_.weights);
  }
  template <typename Code>
  std::uint64_t units_of(const Code& code) const {
    BitCounter counter(*limits_.weights);
    code(counter);
    return counter.units();
  }
  struct Choice {
    std::uint64_t units;
    std::uint32_t a, second;
    double time;
  };
  struct Chosen {
    double time;
    std::int64_t saved;  // units, against the row's reference and that one's own
  };
  Chosen choose(std::uint32_t r, const Group* group, Stands stands, const std::vector<std::uint32_t>& way,
                std::uint32_t kept, double before) {
    constexpr std::size_t other_firsts = 1;
    const std::uint32_t planned = rows_.reference(r);
    const RowCost as_is = cost(r, planned, rows_.reference_of_number(planned));
    if (rows_.plan.raw[r] || !limits_.names_second) return {as_is.microseconds, 0};
    const std::uint32_t place = stands == Stands::in_group ? r - group->first : 0;
    const auto naming = [&](std::uint32_t a) {
      if (place == 0) return std::uint64_t{0};
      return units_of([&](BitCounter& counter) { code_reference(counter, *group, kept, place, a); });
    };
    std::vector<std::pair<std::size_t, std::uint32_t>> firsts;
    const auto offer = [&](std::uint32_t a) {
      if (a != planned) firsts.emplace_back(changes_between(rows_.of_number(a), rows_.row(r)).size(), a);
    };
    for (std::uint32_t i = 0; i < place; ++i) offer(way[i]);
    if (place > 0) offer(group->outside);
    std::ranges::sort(firsts);
    if (firsts.size() > other_firsts) firsts.resize(other_firsts);
    firsts.insert(firsts.begin(), {0, planned});
    const double limit = std::max(as_is.microseconds, longest_ - before);
    Choice best{~std::uint64_t{0}, planned, 0, as_is.microseconds};
    for (const auto& [changes, a] : firsts) {
      const Choice choice = choose_second(r, a, stands, way, kept, limit, naming(a));
      if (choice.units < best.units) best = choice;
    }
    rows_.plan.reference[r] = best.a == 0 ? no_row : best.a - 1;
    rows_.second[r] = best.second;
    return {best.time,
            static_cast<std::int64_t>(as_is.units + naming(planned)) - static_cast<std::int64_t>(best.units)};
  }
  Choice choose_second(std::uint32_t r, std::uint32_t a, Stands stands, const std::vector<std::uint32_t>& way,
                       std::uint32_t kept, double limit, std::uint64_t naming) const {
    constexpr std::size_t most_tried = 6, most_back = 64;
    const std::uint32_t first = rows_.reference_of_number(a);
    const auto steps = static_cast<std::uint32_t>(way.size());
    const Ends of_a = rows_.of_number(a);
    const std::uint32_t context = second_context(stands, of_a.count);
    const auto changes = changes_between(of_a, rows_.row(r));
    const int least = std::min(likeness(of_a, rows_.of_number(first), changes), 0) - 8;
    struct Candidate {
      int score;
      std::uint32_t value, number;
    };
    std::vector<Candidate> candidates;
    const auto offer = [&](std::uint32_t value, std::uint32_t number, int score) {
      if (number != a && number != first && score > least) candidates.push_back({score, value, number});
    };
    for (std::uint32_t i = 0; i < std::min<std::size_t>(steps, most_back); ++i)
      offer(i + 1, way[i], likeness(of_a, rows_.of_number(way[i]), changes));
    const std::vector<int> of_kept = likeness_of_kept(of_a, changes);
    for (std::uint32_t number = 0; number <= kept; ++number)
      offer(steps + 1 + number, number, of_kept[number]);
    const std::size_t tried = std::min(candidates.size(), most_tried);
    std::ranges::partial_sort(candidates, candidates.begin() + static_cast<std::ptrdiff_t>(tried), {},
                              [](const Candidate& c) { return std::pair(-c.score, c.value); });
    candidates.resize(tried);
    candidates.push_back({0, 0, first});
    Choice best{~std::uint64_t{0}, a, 0, 0};
    for (const Candidate& candidate : candidates) {
      const RowCost then = cost(r, a, candidate.number);
      if (then.raw || then.microseconds > limit) continue;
      const std::uint64_t units = then.units + naming + units_of([&](BitCounter& counter) {
                                    code_second(counter, context, kept, steps, candidate.value);
                                  });
      if (units < best.units) best = {units, a, candidate.value, then.microseconds};
    }
    return best;
  }
  // likeness() for the rows that readers keep, by their numbers: the same figures from what run ends they have in common.
  std::vector<int> likeness_of_kept(Ends a, const std::vector<std::uint32_t>& changes) const {
    const std::span of_a(a.at, a.count);
    std::vector<std::uint32_t> lost, gained;  // of a's run ends, of those of the row
    std::ranges::set_intersection(changes, of_a, std::back_inserter(lost));
    std::ranges::set_difference(changes, of_a, std::back_inserter(gained));
    std::vector<int> common(rows_.plan.kept), in_gained(rows_.plan.kept), in_lost(rows_.plan.kept);
    kept_ends_.count_common(of_a, common.data());
    kept_ends_.count_common(gained, in_gained.data());
    kept_ends_.count_common(lost, in_lost.data());
    const int of_none = static_cast<int>(lost.size()), ends = static_cast<int>(a.count);
    std::vector<int> scores = {likeness(of_none, ends)};  // the row without ones has lost all of them
    for (std::uint32_t r = 0; r < rows_.plan.kept; ++r)
      scores.push_back(likeness(of_none - in_lost[r] + in_gained[r],
                                ends + static_cast<int>(rows_.row(r).count) - 2 * common[r]));
    return scores;
  }

  CodedRows& rows_;
  const RowLimits& limits_;
  InvertedIndex kept_ends_;
  double longest_ = 0;
};

// ---- common runs ---------------------------------------------------------------------------------------------------

// A run that the references lack.
struct NewRun {
  CommonRuns::Slots room;  // the columns that it may have, as the first and the one behind the last
  std::uint32_t start, end;
  std::uint64_t units;  // bits of telling where it is, without common runs
};

class NewRunList : public BitCounter {
 public:
  using BitCounter::BitCounter;
  void before_run(std::pair<std::uint32_t, std::uint32_t> room, std::pair<std::uint32_t, std::uint32_t> run) {
    list.push_back({{room.first, room.second}, run.first, run.second, units()});
  }
  void after_run() { list.back().units = units() - list.back().units; }
  std::vector<NewRun> list;
};

template <typename Coder>
void code_all(Coder& coder, const CodedRows& rows, const CommonRuns& runs) {
  const auto code_one = [&](std::uint32_t r, const std::vector<std::uint32_t>& way) {
    if (rows.plan.raw[r]) return;
    const Ends a = rows.of_number(rows.reference(r)), b = rows.of_number(rows.second_number(r, way));
    const std::uint32_t columns = rows.ends.columns();
    NoOut out;
    code_row(coder, a, b, runs, rows.second[r] != 0, columns, {rows.row(r).at, false},
             changed_segments(a, b, rows.row(r), columns), out);
  };
  for (std::uint32_t r = 0; r < rows.plan.kept; ++r) code_one(r, {});
  for (const Group& group : rows.groups) {
    for (std::uint32_t r = group.first; r < group.first + group.size; ++r) code_one(r, rows.way_to(group, r));
  }
}

// Bits of listing the runs.
std::uint64_t units_of_list(const CommonRuns& runs, std::uint32_t columns, const RowWeights& weights) {
  BitCounter counter(weights);
  code_common_runs(counter, columns, runs);
  return counter.units();
}

// Runs leave where what they save is less than what it takes to list them.
CommonRuns common_runs(const CodedRows& rows, const RowWeights& weights) {
  constexpr std::int64_t listed = 11 * bit_unit, named = bit_unit;
  NewRunList found(weights);
  code_all(found, rows, {});
  struct Entry {
    CommonRuns::Run run;
    std::uint32_t count;
    std::int64_t saved = 0;
  };
  std::vector<std::pair<std::uint32_t, std::uint32_t>> all;
  for (const NewRun& run : found.list) all.emplace_back(run.start, run.end);
  std::ranges::sort(all);
  std::vector<Entry> entries;
  for (std::size_t i = 0; i < all.size();) {
    std::size_t end = i;
    while (end < all.size() && all[end] == all[i]) ++end;
    if (const auto count = static_cast<std::uint32_t>(end - i); count > 1) {
      const auto octave = static_cast<std::uint32_t>(std::bit_width(count)) - 2;
      entries.push_back({{all[i].first, all[i].second, std::min(octave, CommonRuns::octaves - 1)}, count});
    }
    i = end;
  }
  CommonRuns runs;
  for (int round = 0; round < 6; ++round) {
    if (entries.size() > CommonRuns::most) {
      std::ranges::stable_sort(entries, [](const Entry& a, const Entry& b) {
        return a.saved != b.saved ? a.saved > b.saved : a.count > b.count;
      });
      entries.resize(CommonRuns::most);
      std::ranges::sort(entries, {}, &Entry::run);
    }
    std::vector<CommonRuns::Run> list;
    for (Entry& entry : entries) {
      entry.saved = 0;
      list.push_back(entry.run);
    }
    runs = CommonRuns(std::move(list), rows.ends.columns());
    if (round == 5) break;
    for (const NewRun& run : found.list) {
      const std::uint32_t index = runs.find(run.start, run.end);
      if (index == CommonRuns::none) continue;
      BitCounter counter(weights);
      counter.take(runs.starting(run.room.first, run.room.count).count, 0, entries[index].run.octave);
      entries[index].saved +=
          static_cast<std::int64_t>(run.units) - static_cast<std::int64_t>(counter.units()) - named;
    }
    std::erase_if(entries, [&](const Entry& entry) { return entry.saved < listed; });
  }
  const std::uint32_t columns = rows.ends.columns();
  BitCounter with(weights);
  code_all(with, rows, runs);
  const bool saves = units_of_list(runs, columns, weights) + with.units() <
                     units_of_list({}, columns, weights) + found.units();
  return saves ? runs : CommonRuns();
}

}  // namespace

std::vector<std::uint32_t> CodedRows::way_to(const Group& group, std::uint32_t r) const {
  std::vector<std::uint32_t> way;
  std::uint32_t last = r;  // the number of the last row decoded before it
  for (const Group* in = &group;; in = &groups[in->above]) {
    for (; last > in->first && way.size() < ModelledRowFormat::longest_way; --last) way.push_back(last);
    if (in->above == Group::none || way.size() == ModelledRowFormat::longest_way) return way;
    last = in->outside;
  }
}

void choose_rest(CodedRows& rows, const RowLimits& limits, unsigned threads) {
  ReferenceChoice(rows, limits, threads);
  if (limits.names_runs) rows.runs = common_runs(rows, *limits.weights);
}

}  // namespace vismat
