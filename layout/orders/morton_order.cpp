#include "layout/orders/morton_order.h"

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "matrix/base/z_order.h"

namespace vismat {

Permutation morton_order(std::span<const Box> bounds) {
  Box around = empty_box;
  for (const Box& box : bounds) grow(around, centre_of(box));
  std::vector<std::pair<std::uint64_t, std::uint32_t>> coded;
  for (const Box& box : bounds) {
    const auto at = [&, centre = centre_of(box)](std::size_t axis) {  // 0 to 2^21 - 1
      const float extent = around.high[axis] - around.low[axis];
      const float part = extent > 0 ? (centre[axis] - around.low[axis]) / extent : 0;
      return static_cast<std::uint32_t>(part * 0x1fffff);
    };
    coded.emplace_back(z_order(at(0), at(1), at(2)), static_cast<std::uint32_t>(coded.size()));
  }
  std::sort(coded.begin(), coded.end());
  std::vector<std::uint32_t> order;
  for (const auto& [code, object] : coded) order.push_back(object);
  return Permutation::from_old_of_new(std::move(order));
}

}  // namespace vismat
