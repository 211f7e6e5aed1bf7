#include "visibility/geometry/touching_boxes.h"

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

namespace vismat {
namespace {

bool apart(const Box& a, const Box& b, std::size_t axis) {
  return a.high[axis] < b.low[axis] || b.high[axis] < a.low[axis];
}

// Of two boxes that are apart on no axis.
bool share_a_face(const Box& a, const Box& b) {
  int touching = 0, overlapping = 0;  // axes; on those left both are flat, in the same plane
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const float low = std::max(a.low[axis], b.low[axis]), high = std::min(a.high[axis], b.high[axis]);
    const bool both_flat = a.low[axis] == a.high[axis] && b.low[axis] == b.high[axis];
    touching += low == high && !both_flat;
    overlapping += low < high;
  }
  return touching <= 1 && touching + overlapping > 0;
}

// The boxes by where they begin on the axis, and how many pairs have a point of it in common.
struct Sweep {
  std::size_t axis;
  std::vector<std::uint32_t> order;
  std::uint64_t pairs = 0;
};
Sweep sweep_along(std::size_t axis, std::span<const Box> boxes) {
  Sweep sweep = {axis, std::vector<std::uint32_t>(boxes.size())};
  std::iota(sweep.order.begin(), sweep.order.end(), 0u);
  const auto begin = [&](std::uint32_t b) { return boxes[b].low[axis]; };
  std::ranges::stable_sort(sweep.order, {}, begin);
  for (std::size_t i = 0; i < sweep.order.size(); ++i) {
    const auto end = std::ranges::upper_bound(sweep.order, boxes[sweep.order[i]].high[axis], {}, begin);
    sweep.pairs += static_cast<std::uint64_t>(end - sweep.order.begin()) - i - 1;
  }
  return sweep;
}

}  // namespace

VisibilityMatrix touching_boxes(std::span<const Box> boxes) {
  Sweep best = sweep_along(0, boxes);
  for (const std::size_t axis : {1, 2}) {
    Sweep other = sweep_along(axis, boxes);
    if (other.pairs < best.pairs) best = std::move(other);
  }
  std::vector<Box> sorted;  // so that the sweep reads memory in sequence
  sorted.reserve(boxes.size());
  for (const std::uint32_t b : best.order) sorted.push_back(boxes[b]);
  const std::size_t axes[] = {best.axis, (best.axis + 1) % 3, (best.axis + 2) % 3};
  std::vector<std::vector<std::uint32_t>> neighbours(boxes.size());
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    const float end = sorted[i].high[axes[0]];
    for (std::size_t j = i + 1; j < sorted.size() && sorted[j].low[axes[0]] <= end; ++j) {
      if (apart(sorted[i], sorted[j], axes[1]) || apart(sorted[i], sorted[j], axes[2])) continue;
      if (!share_a_face(sorted[i], sorted[j])) continue;
      neighbours[best.order[i]].push_back(best.order[j]);
      neighbours[best.order[j]].push_back(best.order[i]);
    }
  }
  for (auto& row : neighbours) std::ranges::sort(row);
  return VisibilityMatrix::from_rows(neighbours, static_cast<std::uint32_t>(boxes.size()));
}

}  // namespace vismat
