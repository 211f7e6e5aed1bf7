// Lengths from 1 to 2^32 - 1 as one of 168 symbols and some raw bits, so that an entropy coder's table stays small.
//
//   length   1 .. 64          symbol length - 1, no raw bits
//   length   1 m m r r ... r  (binary, from 65 on: e bits below the leading one, e >= 6)
//                             symbol 64 + 4 (e - 6) + mm, e - 2 raw bits r
#pragma once
#include <array>
#include <bit>
#include <cstdint>
#include <span>

namespace vismat {

struct LengthSymbol {
  static constexpr std::uint32_t count = 64 + 4 * 26;
  std::uint32_t symbol;
  unsigned raw_count;
  std::uint32_t raw;
};

inline LengthSymbol symbol_of_length(std::uint32_t length) {
  if (length <= 64) return {length - 1, 0, 0};
  const auto e = static_cast<unsigned>(std::bit_width(length)) - 1;
  const std::uint32_t below = length - (std::uint32_t{1} << e);
  return {64 + 4 * (e - 6) + (below >> (e - 2)), e - 2, below & ((std::uint32_t{1} << (e - 2)) - 1)};
}

/// How often each symbol occurs among a list's numbers, those at even places and those at odd ones.
using SymbolCounts = std::array<std::array<std::uint64_t, LengthSymbol::count>, 2>;
inline void count_symbols(std::span<const std::uint32_t> numbers, SymbolCounts& counts) {
  for (std::size_t i = 0; i < numbers.size(); ++i) ++counts[i % 2][symbol_of_length(numbers[i]).symbol];
}

inline unsigned raw_bits_of_symbol(std::uint32_t symbol) {
  return symbol < 64 ? 0 : 4 + (symbol - 64) / 4;
}

inline std::uint32_t length_of_symbol(std::uint32_t symbol, std::uint32_t raw) {
  if (symbol < 64) return symbol + 1;
  const unsigned e = 6 + (symbol - 64) / 4;
  return (std::uint32_t{1} << e) + ((symbol - 64) % 4 << (e - 2)) + raw;
}

}  // namespace vismat
