// Places along the Z-curve.
#pragma once
#include <cstdint>

namespace vismat {

/// Bits of x and y interleaved, x lowest.
inline std::uint64_t z_order(std::uint32_t x, std::uint32_t y) {
  std::uint64_t key = 0;
  for (unsigned bit = 0; bit < 32; ++bit) {
    key |= std::uint64_t{x >> bit & 1} << (2 * bit) | std::uint64_t{y >> bit & 1} << (2 * bit + 1);
  }
  return key;
}

/// Bits of x, y and z interleaved, x lowest; 21 bits of each.
inline std::uint64_t z_order(std::uint32_t x, std::uint32_t y, std::uint32_t z) {
  std::uint64_t key = 0;
  for (unsigned bit = 0; bit < 21; ++bit) {
    key |= (std::uint64_t{x >> bit & 1} | std::uint64_t{y >> bit & 1} << 1 | std::uint64_t{z >> bit & 1} << 2)
           << 3 * bit;
  }
  return key;
}

}  // namespace vismat
