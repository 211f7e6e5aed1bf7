// How Elias and Fano's list of ascending numbers [Elias 1974, Fano 1971] splits each: low bits as they are, high ones in unary.
#pragma once
#include <bit>
#include <cstdint>

namespace vismat {

/// Of `count` numbers up to `largest`: as many low bits as make the list shortest, to within a bit in two numbers.
inline unsigned elias_fano_low_bits(std::uint64_t count, std::uint64_t largest) {
  return count == 0 || largest / count < 2 ? 0 : static_cast<unsigned>(std::bit_width(largest / count)) - 1;
}

}  // namespace vismat
