// Rice's code [Rice 1979] with one parameter for gaps and one for runs.
//
//   byte   the parameter k of the numbers at even places in bits 0 to 3, of those at odd places in bits 4 to 7
//   bits   for each number x, with q = floor((x - 1) / 2^k): if q < 24, q zeros, a 1 and the k low bits of x - 1;
//          otherwise 24 zeros and the 32 bits of x
//
// The parameters are stored in each list, not once in a file; docs/codecs.md has the figures.
//
// The worst row, without the escape: the costs of x with k = 0 and with k = 1, weighted 36 to 31, have a mean of at
// most 98/67 x for every x, with equality at 1 and at 25; so the cheaper k costs no more. Gaps and runs of 42 ones and
// a 25, again and again, take 98/67 = 1.46 bits for each column.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "codecs/entropy/list_bits.h"

namespace vismat {

/// A code for PairRows (pairs.h).
struct RiceCode {
  /// Appends a list of numbers of at least 1. Tries each of 16 parameters: linear, about 20 operations for each number.
  static void put(std::vector<std::byte>& out, std::span<const std::uint32_t> numbers);
  class Reader {
   public:
    Reader(const RiceCode&, std::span<const std::byte> bytes);
    std::size_t read(std::span<std::uint32_t> out);

   private:
    ListBits bits_;
    std::array<unsigned, 2> parameters_;  // the first is for the next number
  };
};

}  // namespace vismat
