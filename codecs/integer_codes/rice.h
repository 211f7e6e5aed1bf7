// Rice's code [Rice 1979] with a parameter each for gaps and for runs.
//
//   byte   the parameter k of the numbers at even places in bits 0 to 3, of those at odd ones in bits 4 to 7
//   bits   for each number x, with q = floor((x - 1) / 2^k): q zeros, a 1 and the k low bits of x - 1 where q < 24;
//          else 24 zeros and the 32 bits of x
//
// The parameters stand in each list, not once a file: in the natural order of a level's cells and faces that is 4 to 7 %
// smaller, a byte a row included; rows of cities and differences stay within 2 % either way.
//
// Worst row, without the escape: the costs of x with k = 0 and with k = 1, weighed 36 to 31, have a mean of at most 98/67 x
// for every x, and that at 1 and at 25; so the cheaper k costs no more. Gaps and runs of 42 ones and a 25, over and
// over, take 98/67 = 1.46 bits a column.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "codecs/entropy/list_bits.h"

namespace vismat {

/// A code for PairRows (pairs.h).
struct RiceCode {
  /// Appends a list; numbers of at least 1. Tries each of 16 parameters: linear, about 20 operations a number.
  static void put(std::vector<std::byte>& out, std::span<const std::uint32_t> numbers);
  class Reader {
   public:
    Reader(const RiceCode&, std::span<const std::byte> bytes);
    std::size_t read(std::span<std::uint32_t> out);

   private:
    ListBits bits_;
    std::array<unsigned, 2> parameters_;  // the first is the next number's
  };
};

}  // namespace vismat
