// ALGORITHM. Agglomeration, restricted to the neighbours of an order: each join looks at two distances instead of all,
// so 3 n distances take the place of n^2. Coded over the tree (gotsman3-context), two levels' matrices are within 2 %
// either way of the tree that may join any two sets. Halving the order again and again instead makes 6 % to 16 % more
// bytes, and k-d trees over the view cells' boxes 24 % to 60 % more. On artificial 1 k-d trees also make 6 % to 9 %
// more, on artificial 2 2 % to 6 % fewer: there boxes say all. Keys that favour small unions or even trees gained up to
// 2 % on one level and lost up to 2 % on the other. bench gotsman-tables compares the tree with the k-d tree.
#include "layout/trees/set_tree.h"

#include <algorithm>
#include <array>
#include <compare>
#include <functional>
#include <queue>
#include <utility>
#include <vector>

#include "layout/best_order.h"
#include "matrix/bit_rows.h"

namespace vismat {

ObjectTree tree_by_sets(const VisibilityMatrix& matrix, const Stages& stages) {
  const std::uint32_t rows = matrix.shape().rows;
  if (rows == 0) return {};
  const auto order = best_order(transpose(matrix), {.stages = stages}).old_of_new();

  // Sets 0 to rows - 1 are the rows, the others joins in the order in which they were made. A join's words are where its
  // first part's were.
  BitRows words(matrix);
  constexpr std::uint32_t none = ObjectTree::none;
  const std::size_t sets = 2 * std::size_t{rows} - 1;
  std::vector<std::uint32_t> words_of_set(sets), before(sets, none), after(sets, none);
  std::vector<std::array<std::uint32_t, 2>> parts_of_join;
  std::vector<bool> joined(sets, false);
  for (std::uint32_t r = 0; r < rows; ++r) words_of_set[r] = r;

  struct Pair {
    std::uint32_t distance, newer, first, second;  // newer: the larger number of the two
    auto operator<=>(const Pair&) const = default;
  };
  // Of equally near pairs the oldest, so that ties make even trees.
  std::priority_queue<Pair, std::vector<Pair>, std::greater<>> pairs;
  const auto link = [&](std::uint32_t first, std::uint32_t second) {
    if (first == none || second == none) return;
    after[first] = second;
    before[second] = first;
    pairs.push({hamming_distance(words.row(words_of_set[first]), words.row(words_of_set[second])),
                std::max(first, second), first, second});
  };
  for (std::uint32_t i = 0; i + 1 < rows; ++i) link(order[i], order[i + 1]);
  while (!pairs.empty()) {
    const auto [distance, newer, first, second] = pairs.top();
    pairs.pop();
    if (joined[first] || joined[second]) continue;
    joined[first] = joined[second] = true;
    const auto set = static_cast<std::uint32_t>(rows + parts_of_join.size());
    parts_of_join.push_back({first, second});
    words_of_set[set] = words_of_set[first];
    const auto into = words.row(words_of_set[first]);
    const auto from = words.row(words_of_set[second]);
    for (std::size_t w = 0; w < into.size(); ++w) into[w] |= from[w];
    link(before[first], set);
    link(set, after[second]);
  }

  struct Branch {
    std::uint32_t set, parent;
  };
  std::vector<Branch> waiting = {{static_cast<std::uint32_t>(sets - 1), none}};
  std::vector<std::uint32_t> parent_of_node, row_of_node;
  while (!waiting.empty()) {
    const auto [set, parent] = waiting.back();
    waiting.pop_back();
    const auto node = static_cast<std::uint32_t>(parent_of_node.size());
    parent_of_node.push_back(parent);
    row_of_node.push_back(set < rows ? set : none);
    if (set < rows) continue;
    const auto [first, second] = parts_of_join[set - rows];
    waiting.push_back({second, node});
    waiting.push_back({first, node});
  }
  return ObjectTree::from_parents(std::move(parent_of_node), std::move(row_of_node), rows);
}

}  // namespace vismat
