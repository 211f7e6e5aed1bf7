// Places along the Z-order curve (Morton codes), which keeps near points near.
#pragma once
#include <cstdint>

namespace vismat {

/// The bits of x and y interleaved, with x lowest.
inline std::uint64_t z_order(std::uint32_t x, std::uint32_t y) {
  const auto spread = [](std::uint64_t value) {  // to every second bit
    value = (value | value << 16) & 0x0000ffff0000ffff;
    value = (value | value << 8) & 0x00ff00ff00ff00ff;
    value = (value | value << 4) & 0x0f0f0f0f0f0f0f0f;
    value = (value | value << 2) & 0x3333333333333333;
    return (value | value << 1) & 0x5555555555555555;
  };
  return spread(x) | spread(y) << 1;
}

/// The lowest 21 bits of x, y and z interleaved, with x lowest.
inline std::uint64_t z_order(std::uint32_t x, std::uint32_t y, std::uint32_t z) {
  const auto spread = [](std::uint64_t value) {  // to every third bit
    value &= 0x1fffff;
    value = (value | value << 32) & 0x1f00000000ffff;
    value = (value | value << 16) & 0x1f0000ff0000ff;
    value = (value | value << 8) & 0x100f00f00f00f00f;
    value = (value | value << 4) & 0x10c30c30c30c30c3;
    return (value | value << 2) & 0x1249249249249249;
  };
  return spread(x) | spread(y) << 1 | spread(z) << 2;
}

}  // namespace vismat
