// The delimiter code for short lists of small numbers [Chhugani et al. 2005, Appendix A], in the reading that is
// uniquely decodable (delimiter.cpp says why, and where the printed rules are not).
//
// A number is written in binary from its highest bit on, then
//   - behind each 11, from the left and without overlap, a 0 is put (111 becomes 1101);
//   - what then ends in 01 gets one more 1 (5, that is 101, becomes 1011), and so does the number 1 itself (11).
// Between two numbers stands the delimiter 11. Bits fill bytes from the lowest on. A 1 behind the last number and zeros up
// to the byte end the list: the last 1 of the bytes is where it stops. No number, no byte.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace vismat {

/// The most bits that a number of `bits` >= 1 significant bits takes, without delimiter: half as many again, rounded up.
constexpr unsigned longest_delimited(unsigned bits) {
  return bits + (bits + 1) / 2;
}

/// Appends the code of `numbers`, each at least 1. Linear; every list has one code and every code one list.
void put_delimited(std::vector<std::byte>& out, std::span<const std::uint32_t> numbers);

/// Decodes the numbers of one list piece by piece, in linear time and without memory of its own. Borrows the bytes.
class DelimitedReader {
 public:
  /// FormatError where no bit ends the list: the last byte is zero. `by_extraction`: with the processor's instruction that
  /// extracts bits (BMI2's pext) or without; for tests, which want both. The numbers are the same.
  explicit DelimitedReader(std::span<const std::byte> bytes, bool by_extraction = has_fast_extraction());
  /// Whether this processor has it and does not take it bit by bit.
  static bool has_fast_extraction();
  /// Writes the next numbers to the front of `out`, which must hold `least_room`, and gives their count: as many as surely
  /// fit, 0 only at the end. What lies behind them in `out` may be written over. Throws FormatError with the bit's place at
  /// bytes that put_delimited cannot have made; numbers given before that are void.
  std::size_t read(std::span<std::uint32_t> out);
  static constexpr std::size_t least_room = 64;

 private:
  std::uint64_t zeros_from(std::int64_t place) const;
  std::int64_t ones_from(std::int64_t place, std::int64_t enough) const;
  std::uint32_t* read_run(std::uint32_t* to, std::uint32_t* end);
  template <typename Numbers>
  std::size_t read_by(std::span<std::uint32_t> out);

  const std::byte* bytes_;
  std::int64_t tail_begin_;  // the byte from which on tail_ is read in place of bytes_
  std::int64_t next_;        // the delimiter before the next number; before the first, -2
  std::int64_t stop_;        // the bit that ends the list
  bool by_extraction_;
  std::array<std::byte, 24> tail_{};
};

}  // namespace vismat
