// The split of Elias and Fano's list of ascending numbers [Elias 1974, Fano 1971]: low bits as they are, high bits in
// unary.
#pragma once
#include <bit>
#include <cstdint>

namespace vismat {

/// For `count` numbers up to `largest`: the number of low bits with which the list is shortest, to within a bit in two
/// numbers.
inline unsigned elias_fano_low_bits(std::uint64_t count, std::uint64_t largest) {
  return count == 0 || largest / count < 2 ? 0 : static_cast<unsigned>(std::bit_width(largest / count)) - 1;
}

}  // namespace vismat
