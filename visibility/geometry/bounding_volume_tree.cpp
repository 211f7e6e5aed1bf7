// A node's objects are halved at the median of their centres along the widest axis, the halves again, until
// there are `arity` parts: for 4, twice. A tree of full nodes needs 1 (mod arity - 1) objects under each, so
// a cut moves from the median to the nearest place that gives such parts. Plain medians leave the lowest
// nodes two or three children: 3780 nodes over oa_koth1's 2415 clusters, where this makes 3220.
#include "visibility/geometry/bounding_volume_tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace vismat {
namespace {

using Centre = std::array<float, 3>;
using Objects = std::span<std::uint32_t>;

std::size_t widest_axis(std::span<const Centre> centres, Objects objects) {
  Box around = empty_box;
  for (const std::uint32_t object : objects) grow(around, centres[object]);
  const auto& [low, high] = around;
  std::size_t widest = 0;
  for (std::size_t k = 1; k < 3; ++k) {
    if (high[k] - low[k] > high[widest] - low[widest]) widest = k;
  }
  return widest;
}

// How many of `size` objects the first `first` of `parts` parts get: near the median, and such that each of
// these parts can be a full tree.
std::size_t first_share(std::size_t size, std::size_t first, std::size_t parts, std::size_t arity) {
  const std::size_t step = arity - 1, median = size * first / parts;
  const std::size_t share = first + (std::max(median, first) - first + step / 2) / step * step;
  return share <= size - (parts - first) ? share : share - step;
}

void split(std::span<const Centre> centres, Objects objects, std::size_t parts, std::size_t arity,
           std::vector<Objects>& out) {
  if (parts == 1) {
    out.push_back(objects);
    return;
  }
  const std::size_t axis = widest_axis(centres, objects), first = parts / 2;
  const std::size_t share = first_share(objects.size(), first, parts, arity);
  std::nth_element(objects.begin(), objects.begin() + static_cast<std::ptrdiff_t>(share), objects.end(),
                   [&](std::uint32_t a, std::uint32_t b) {
                     return std::pair(centres[a][axis], a) < std::pair(centres[b][axis], b);
                   });
  split(centres, objects.first(share), first, arity, out);
  split(centres, objects.subspan(share), parts - first, arity, out);
}

}  // namespace

ObjectTree bounding_volume_tree(std::span<const Box> boxes, unsigned arity) {
  if (arity < 2)
    throw std::invalid_argument("a tree's nodes need an arity of at least 2, not " + std::to_string(arity));
  std::vector<Centre> centres;
  centres.reserve(boxes.size());
  for (const Box& box : boxes) {
    centres.push_back(centre_of(box));
    if (!std::ranges::all_of(centres.back(), [](float c) { return std::isfinite(c); }))
      throw std::invalid_argument("box " + std::to_string(centres.size() - 1) + " is not finite");
  }
  std::vector<std::uint32_t> order(boxes.size());
  std::iota(order.begin(), order.end(), 0u);

  std::vector<std::uint32_t> parent_of_node, object_of_node;
  std::vector<Objects> objects_of_node, parts;
  const auto add = [&](std::uint32_t parent, Objects objects) {
    parent_of_node.push_back(parent);
    object_of_node.push_back(objects.size() == 1 ? objects[0] : ObjectTree::none);
    objects_of_node.push_back(objects);
  };
  if (!order.empty()) add(ObjectTree::none, order);
  for (std::uint32_t node = 0; node < objects_of_node.size(); ++node) {
    const Objects objects = objects_of_node[node];
    if (objects.size() == 1) continue;
    parts.clear();
    split(centres, objects, std::min<std::size_t>(arity, objects.size()), arity, parts);
    for (const Objects part : parts) add(node, part);
  }
  return ObjectTree::from_parents(std::move(parent_of_node), std::move(object_of_node),
                                  static_cast<std::uint32_t>(boxes.size()));
}

}  // namespace vismat
