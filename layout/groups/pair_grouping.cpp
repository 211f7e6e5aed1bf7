// ALGORITHM. Merging the best of all pairs, not the best of some seeds' pairs. Each group has searched all others and
// waits in a queue with its best partner. If that partner has changed since, the next one of those found takes its
// place, and when all of them are used up the group searches anew. This is exact: of the best pair, the group that
// changed later has examined the other as it is now, and what it found is passed over only if it has changed. With
// bits, whose searches end early by the limit of the best partner, only that one is found; where scores are equal, the
// choice among equals can differ from that with more.
//
// A search takes 0.1 ms among 24,565 rows of 5,461 columns: groups of near rows come first, the score's limit gives a
// limit on the distance, and a first distance on 512 folded bits halves the time. Scores weighted by what a merge saves
// (distance, or distance and a constant) left more bytes or as many; so did filling short runs of zeros with ones in
// place of half of the merges or of all.
//
// From some tens of thousands of sparse rows on, comparing all takes minutes. Groups then search only among those that
// their members' near rows are in now: near_points finds the rows, a merged group's candidates are those of its parts,
// and only a group that has few of them left searches all. When few groups remain, all pairs are compared as above.
//
// Greedy groups are not the best: moving single rows to other groups regains occlusions, and spending them on more
// merges leaves fewer groups (docs/lossy.md), 2 % fewer on oa_thor's faces.
#include "layout/groups/pair_grouping.h"

#include <algorithm>
#include <queue>
#include <thread>
#include <tuple>
#include <vector>

#include "layout/groups/row_groups.h"
#include "matrix/points/near.h"

namespace vismat {
namespace {

// The search of a sparse row takes as long for one partner as for many. On the power plant at 1/32 the searches beside
// those of merged groups fall from 26,800 with one to 10,300 with 8, 6,000 with 32 and 4,500 with 64.
constexpr std::uint32_t most_found = 32;
// A group with fewer candidates searches all others.
constexpr std::uint32_t fewest_near = 8;
// That takes as long as to read all sets; after so many times, as long as to keep an index of the sets from then on.
constexpr std::uint32_t most_scans = 64;

// For each group the distinct rows whose groups it looks at.
struct NearLists {
  std::vector<std::vector<std::uint32_t>> of_group;
  std::uint32_t few_groups = 0;
};

// Until the next pair would lose too much or, among near rows, few groups are left.
void merge_pairs(RowGroups& groups, const GroupingOptions& options, NearLists* near = nullptr) {
  struct Entry {
    std::uint64_t score;
    std::uint32_t group, partner;
    std::uint32_t group_age;  // how often it had been merged
    bool operator>(const Entry& other) const {
      return std::tie(score, group, partner) > std::tie(other.score, other.group, other.partner);
    }
  };
  struct Found {
    RowGroups::Pair pair;
    std::uint32_t partner_age;
  };
  const unsigned several =
      options.threads != 0 ? options.threads : std::max(1u, std::thread::hardware_concurrency());
  const std::vector<std::uint32_t> alive(groups.alive().begin(), groups.alive().end());
  const std::size_t numbers = alive.empty() ? 0 : *std::ranges::max_element(alive) + std::size_t{1};
  std::vector<std::uint32_t> age(numbers, 0);
  std::vector<std::vector<Found>> found(numbers);  // by group, the best last
  const auto take = [&](std::uint32_t group, const std::vector<RowGroups::Pair>& pairs) {
    found[group].clear();
    for (const RowGroups::Pair& pair : pairs) found[group].push_back({pair, age[pair.partner]});
    std::ranges::reverse(found[group]);
    if (near == nullptr) return;
    near->of_group[group].clear();
    for (const RowGroups::Pair& pair : pairs) near->of_group[group].push_back(pair.partner);
  };
  const auto search_all = [&](std::uint32_t group, unsigned threads) {
    take(group, groups.best_partners(group, groups.sparse() ? most_found : 1, threads));
  };
  const auto search_near = [&](std::uint32_t group) {
    take(group, groups.best_among(group, near->of_group[group], most_found));
    return found[group].size() >= fewest_near;
  };
  std::uint32_t scans = 0;
  const auto search = [&](std::uint32_t group) {
    if (near != nullptr && search_near(group)) return;
    if (!groups.indexed() && groups.sparse() && ++scans > most_scans) groups.make_index();
    search_all(group, several);
  };
  std::vector<std::uint32_t> lonely;  // with too few near ones
  if (near != nullptr) {
    std::vector<char> enough(alive.size());
    parallel_for(alive.size(), options.threads, [&](std::uint64_t i) { enough[i] = search_near(alive[i]); });
    for (std::size_t i = 0; i < alive.size(); ++i) {
      if (!enough[i]) lonely.push_back(alive[i]);
    }
    if (lonely.size() > most_scans) groups.make_index();
  } else {
    lonely = alive;
  }
  parallel_for(lonely.size(), options.threads, [&](std::uint64_t i) { search_all(lonely[i], 1); });

  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  const auto push = [&](std::uint32_t group) {
    if (found[group].empty()) return;
    const RowGroups::Pair& pair = found[group].back().pair;
    queue.push({pair.score, group, pair.partner, age[group]});
  };
  for (const std::uint32_t group : alive) push(group);

  while (!queue.empty() && queue.top().score <= options.lost - groups.lost() &&
         (near == nullptr || groups.alive().size() > near->few_groups)) {
    const Entry top = queue.top();
    queue.pop();
    if (!groups.is_alive(top.group) || age[top.group] != top.group_age) continue;
    const bool fresh =
        groups.is_alive(top.partner) && age[top.partner] == found[top.group].back().partner_age;
    if (!fresh || groups.score(top.group, top.partner) != top.score) {  // columns may have no more room
      found[top.group].pop_back();
      if (found[top.group].empty()) search(top.group);
      push(top.group);
      continue;
    }
    const auto [into, from] = std::minmax(top.group, top.partner);
    groups.merge(into, from);
    ++age[into];
    found[from] = {};
    if (near != nullptr) {
      near->of_group[into].insert(near->of_group[into].end(), near->of_group[from].begin(),
                                  near->of_group[from].end());
      near->of_group[from] = {};
    }
    search(into);
    push(into);
    if (options.progress) options.progress(groups.lost(), options.lost);
  }
}

NearLists near_rows(const RowGroups& groups, const GroupingOptions& options, const PairGroupingOptions& how) {
  const SparsePoints points(transpose(groups.kinds()), false);
  const NeighbourLists lists =
      near_points(points, {.neighbours = most_found, .exact_seconds = 0, .seed = options.seed},
                  options.threads)
          .lists;
  NearLists near{std::vector<std::vector<std::uint32_t>>(points.size()), how.few_groups};
  for (std::size_t p = 0; p < near.of_group.size(); ++p) {
    for (std::size_t n = p * lists.per_point; n < (p + 1) * lists.per_point; ++n) {
      if (lists.ids[n] != no_point) near.of_group[p].push_back(lists.ids[n]);
    }
  }
  return near;
}

}  // namespace

Partition group_rows_by_pairs(const VisibilityMatrix& matrix, const GroupingOptions& options,
                              const PairGroupingOptions& how) {
  RowGroups groups(matrix, options);
  if (groups.sparse() && groups.alive().size() > how.few_groups &&
      all_pairs_cost(groups.kinds()).by_index > 1e9 * how.exact_seconds) {
    NearLists near = near_rows(groups, options, how);
    groups.drop_index();
    merge_pairs(groups, options, &near);
    groups.make_index();
  }
  merge_pairs(groups, options);
  for (std::uint32_t round = 0; round < how.rounds && groups.exchange() > 0; ++round)
    merge_pairs(groups, options);
  return groups.partition();
}

}  // namespace vismat
