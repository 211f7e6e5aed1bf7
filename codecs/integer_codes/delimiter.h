// The delimiter code, for short lists of small numbers [Chhugani et al. 2005, Appendix A], in the interpretation that
// is uniquely decodable; delimiter.cpp says why the printed rules are not.
//
// A number is written in binary from its highest bit on. Then
//   - a 0 is put behind each 11, from the left and without overlap (111 becomes 1101);
//   - if the result ends in 01, one more 1 is appended (5, that is 101, becomes 1011); the number 1 itself becomes 11.
// Between two numbers stands the delimiter 11. Bits fill bytes from the lowest on. Behind the last number a 1 and zeros
// up to a whole byte end the list, so the last 1 of the bytes is the end. A list without numbers has no bytes.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace vismat {

/// The most bits that the code of a number of `bits` >= 1 significant bits takes, without delimiter: half as many
/// again, rounded up.
constexpr unsigned longest_delimited(unsigned bits) {
  return bits + (bits + 1) / 2;
}

/// Appends the code of `numbers`, each at least 1. Linear; each list has one code and each code one list.
void put_delimited(std::vector<std::byte>& out, std::span<const std::uint32_t> numbers);

/// Decodes the numbers of one list piece by piece, in linear time and without memory of its own. Borrows the bytes.
class DelimitedReader {
 public:
  /// Throws FormatError if no bit ends the list, that is, if the last byte is zero. `by_extraction`: whether to use the
  /// processor's instruction that extracts bits (BMI2's pext); tests use both ways. The numbers are the same.
  explicit DelimitedReader(std::span<const std::byte> bytes, bool by_extraction = has_fast_extraction());
  /// Whether this processor has that instruction and does not execute it bit by bit.
  static bool has_fast_extraction();
  /// Writes the next numbers to the front of `out`, which must hold `least_room`, and returns their count: as many as
  /// surely fit, 0 only at the end. What is behind them in `out` may be overwritten. Throws FormatError, which names
  /// the bit, at bytes that put_delimited cannot have made; numbers returned before that are void.
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
