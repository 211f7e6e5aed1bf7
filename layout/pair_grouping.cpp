// ALGORITHM. The best of all pairs is merged, not the best of some seeds'. Each group keeps its best partner in a queue; an
// entry whose partner has changed since is looked up anew when it comes to the top. That is exact: of the best pair the group
// that was changed later has looked at the other as it is now.
#include "layout/pair_grouping.h"

#include <algorithm>
#include <queue>
#include <tuple>
#include <vector>

#include "layout/row_groups.h"

namespace vismat {

Partition group_rows_by_pairs(const VisibilityMatrix& matrix, const GroupingOptions& options) {
  RowGroups groups(matrix, options);
  struct Entry {
    std::uint64_t score;
    std::uint32_t group, partner;
    std::uint32_t group_age, partner_age;  // how often each had been merged
    bool operator>(const Entry& other) const {
      return std::tie(score, group, partner) > std::tie(other.score, other.group, other.partner);
    }
  };
  std::vector<std::uint32_t> age(matrix.shape().rows, 0);
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  const auto push = [&](std::uint32_t group, const RowGroups::Pair& pair) {
    if (pair.partner != RowGroups::none) queue.push({pair.score, group, pair.partner, age[group], age[pair.partner]});
  };
  {
    const auto alive = groups.alive();
    std::vector<RowGroups::Pair> first(alive.size());
    parallel_for(alive.size(), options.threads, [&](std::uint64_t i) { first[i] = groups.best_partner(alive[i]); });
    for (std::size_t i = 0; i < alive.size(); ++i) push(alive[i], first[i]);
  }
  std::uint64_t left = options.lost;
  while (!queue.empty() && queue.top().score <= left) {
    const Entry top = queue.top();
    queue.pop();
    if (!groups.is_alive(top.group) || age[top.group] != top.group_age) continue;
    if (!groups.is_alive(top.partner) || age[top.partner] != top.partner_age ||
        groups.score(top.group, top.partner) != top.score) {  // there was room for it
      push(top.group, groups.best_partner(top.group));
      continue;
    }
    left -= top.score;
    const auto [into, from] = std::minmax(top.group, top.partner);
    groups.merge(into, from);
    ++age[into];
    push(into, groups.best_partner(into));
    if (options.progress) options.progress(options.lost - left, options.lost);
  }
  return groups.partition();
}

}  // namespace vismat
