#include "layout/orders/morton_order.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>
#include <vector>

namespace vismat {
namespace {

// Every third bit of the result, from the lowest on, is a bit of `value`.
std::uint64_t spread(std::uint64_t value) {
  value &= 0x1fffff;
  value = (value | value << 32) & 0x1f00000000ffff;
  value = (value | value << 16) & 0x1f0000ff0000ff;
  value = (value | value << 8) & 0x100f00f00f00f00f;
  value = (value | value << 4) & 0x10c30c30c30c30c3;
  return (value | value << 2) & 0x1249249249249249;
}

}  // namespace

Permutation morton_order(std::span<const Box> bounds) {
  std::array<float, 3> low{}, high{};
  const auto centre = [](const Box& box, std::size_t axis) { return (box.low[axis] + box.high[axis]) / 2; };
  for (std::size_t axis = 0; axis < 3 && !bounds.empty(); ++axis) {
    low[axis] = high[axis] = centre(bounds[0], axis);
    for (const Box& box : bounds) {
      low[axis] = std::min(low[axis], centre(box, axis));
      high[axis] = std::max(high[axis], centre(box, axis));
    }
  }
  std::vector<std::pair<std::uint64_t, std::uint32_t>> coded;
  for (const Box& box : bounds) {
    std::uint64_t code = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const float extent = high[axis] - low[axis];
      const float part = extent > 0 ? (centre(box, axis) - low[axis]) / extent : 0;
      code |= spread(static_cast<std::uint64_t>(part * 0x1fffff)) << axis;
    }
    coded.emplace_back(code, static_cast<std::uint32_t>(coded.size()));
  }
  std::sort(coded.begin(), coded.end());
  std::vector<std::uint32_t> order;
  for (const auto& [code, object] : coded) order.push_back(object);
  return Permutation::from_old_of_new(std::move(order));
}

}  // namespace vismat
