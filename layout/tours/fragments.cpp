#include "layout/tours/fragments.h"

#include <algorithm>

namespace vismat {
namespace {}  // namespace

std::vector<Edge> edges_of(const NeighbourLists& lists) {
  std::vector<Edge> edges;
  edges.reserve(lists.ids.size());
  for (std::size_t i = 0; i < lists.ids.size(); ++i) {
    const auto p = static_cast<std::uint32_t>(i / lists.per_point), q = lists.ids[i];
    if (lists.distances[i] != no_point) edges.push_back({lists.distances[i], std::min(p, q), std::max(p, q)});
  }
  return edges;
}

Fragments::Fragments(std::uint32_t size) : components_(size), links_(size, {no_point, no_point}) {}

bool Fragments::is_end(std::uint32_t p) const {
  return links_[p][1] == no_point;
}

void Fragments::join_shortest_first(std::vector<Edge>& edges) {
  std::sort(edges.begin(), edges.end());
  for (const Edge& e : edges) {
    if (!is_end(e.a) || !is_end(e.b) || same(e.a, e.b)) continue;
    components_.join(components_.find(e.a), components_.find(e.b));
    links_[e.a][links_[e.a][0] != no_point] = e.b;
    links_[e.b][links_[e.b][0] != no_point] = e.a;
  }
}

std::vector<std::uint32_t> Fragments::ends() const {
  std::vector<std::uint32_t> ends;
  for (std::uint32_t p = 0; p < links_.size(); ++p) {
    if (is_end(p)) ends.push_back(p);
  }
  return ends;
}

std::vector<std::uint32_t> Fragments::walk() const {
  std::vector<std::uint32_t> way;
  way.reserve(links_.size());
  for (std::uint32_t at = ends().front(), from = no_point; at != no_point;) {
    way.push_back(at);
    const std::uint32_t to = links_[at][0] != from ? links_[at][0] : links_[at][1];
    from = at;
    at = to;
  }
  return way;
}

}  // namespace vismat
