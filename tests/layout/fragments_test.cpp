// Tests greedy edges on cases that are small enough to check by hand.
#include "layout/tours/fragments.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "tests/codecs/matrices.h"

namespace vismat {
namespace {

TEST(Fragments, TakeTheShortestEdgesThatMakeNoBranchAndNoCycle) {
  Fragments fragments(5);
  std::vector<Edge> edges = {{3, 0, 2}, {1, 0, 1}, {2, 1, 2}, {9, 3, 4}, {4, 1, 3}, {5, 2, 3}};
  fragments.join_shortest_first(edges);  // 0-1, 1-2; 0-2 would close a cycle, 1-3 branch; 2-3, 3-4
  EXPECT_EQ(fragments.ends(), (std::vector<std::uint32_t>{0, 4}));
  EXPECT_EQ(fragments.walk(), (std::vector<std::uint32_t>{0, 1, 2, 3, 4}));
}

TEST(Fragments, JoinAllOfThemWhateverIsLeft) {
  for (const std::uint32_t size : {1u, 2u, 3u, 50u}) {
    Fragments fragments(size);
    std::vector<Edge> edges;
    if (size > 2) edges.push_back({0, 1, 2});
    fragments.join_shortest_first(edges);
    auto way = fragments.join_all([](std::uint32_t a, std::uint32_t b) { return b - a; });
    std::sort(way.begin(), way.end());
    std::vector<std::uint32_t> all(size);
    std::iota(all.begin(), all.end(), 0u);
    EXPECT_EQ(way, all);
  }
}

TEST(Fragments, EdgesOfListsEndWhereTheseDo) {
  const NeighbourLists lists{2, {1, 2, 0, 0xffffffff, 0, 1}, {5, 6, 5, 0xffffffff, 6, 7}};
  EXPECT_EQ(edges_of(lists), (std::vector<Edge>{{5, 0, 1}, {6, 0, 2}, {5, 0, 1}, {6, 0, 2}, {7, 1, 2}}));
}

}  // namespace
}  // namespace vismat
