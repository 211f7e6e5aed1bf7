// ALGORITHM. Merging the best of all pairs, not the best of some seeds' pairs. Each group keeps its best partner in a
// queue. An entry whose partner has changed since is looked up anew when it reaches the top. This is exact: of the best
// pair, the group that changed later has examined the other as it is now.
//
// A search takes 0.1 ms among 24,565 rows of 5,461 columns: groups of near rows come first, the score's limit gives a
// limit on the distance, and a first distance on 512 folded bits halves the time. Scores weighted by what a merge saves
// (distance, or distance and a constant) left more bytes or as many; so did filling short runs of zeros with ones in
// place of half of the merges or of all.
//
// Greedy groups are not the best: moving single rows to other groups regains occlusions, and spending them on more
// merges leaves fewer groups (docs/lossy.md), 2 % fewer on oa_thor's faces.
#include "layout/groups/pair_grouping.h"

#include <algorithm>
#include <queue>
#include <tuple>
#include <vector>

#include "layout/groups/row_groups.h"

namespace vismat {
namespace {

// Until the next pair would lose too much.
void merge_pairs(RowGroups& groups, const GroupingOptions& options) {
  struct Entry {
    std::uint64_t score;
    std::uint32_t group, partner;
    std::uint32_t group_age, partner_age;  // how often each had been merged
    bool operator>(const Entry& other) const {
      return std::tie(score, group, partner) > std::tie(other.score, other.group, other.partner);
    }
  };
  const std::vector<std::uint32_t> alive(groups.alive().begin(), groups.alive().end());
  std::vector<RowGroups::Pair> first(alive.size());
  parallel_for(alive.size(), options.threads,
               [&](std::uint64_t i) { first[i] = groups.best_partner(alive[i]); });
  std::vector<std::uint32_t> age(alive.empty() ? 0 : *std::ranges::max_element(alive) + std::size_t{1}, 0);
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  const auto push = [&](std::uint32_t group, const RowGroups::Pair& pair) {
    if (pair.partner != RowGroups::none)
      queue.push({pair.score, group, pair.partner, age[group], age[pair.partner]});
  };
  for (std::size_t i = 0; i < alive.size(); ++i) push(alive[i], first[i]);

  while (!queue.empty() && queue.top().score <= options.lost - groups.lost()) {
    const Entry top = queue.top();
    queue.pop();
    if (!groups.is_alive(top.group) || age[top.group] != top.group_age) continue;
    const bool fresh = groups.is_alive(top.partner) && age[top.partner] == top.partner_age;
    if (!fresh || groups.score(top.group, top.partner) != top.score) {  // columns may have no more room
      push(top.group, groups.best_partner(top.group));
      continue;
    }
    const auto [into, from] = std::minmax(top.group, top.partner);
    groups.merge(into, from);
    ++age[into];
    push(into, groups.best_partner(into));
    if (options.progress) options.progress(groups.lost(), options.lost);
  }
}

}  // namespace

Partition group_rows_by_pairs(const VisibilityMatrix& matrix, const GroupingOptions& options,
                              std::uint32_t rounds) {
  RowGroups groups(matrix, options);
  merge_pairs(groups, options);
  for (std::uint32_t round = 0; round < rounds && groups.exchange() > 0; ++round)
    merge_pairs(groups, options);
  return groups.partition();
}

}  // namespace vismat
