// Binary interpolative coding [Moffat, Stuiver 2000] of a list's cumulated numbers: the middle one in as few bits as tell
// apart what can stand there between its neighbours, then each half the same way.
//
//   varint   n, how many numbers; at most 2^32 - 1
//   varint   their sum s_n less n
//   bits     with s_0 = 0: open(0, n), where open(a, b) for b - a > 1, m = floor((a + b) / 2) tells
//            v = s_m - s_a - (m - a), one of r = s_b - s_a - (b - a) + 1 values, then open(a, m) and open(m, b).
//            With k = ceil(lg r) and u = 2^k - r: nothing where r = 1; v < u in k - 1 bits; else floor((v + u) / 2)
//            in k - 1 bits and then the lowest bit of v + u
//
// Over the cumulated numbers, that is where runs begin and end, rather than over the ids themselves: on levels' cells
// and faces in `best` order that takes 60 to 76 % of the ids' bytes, unordered 86 to 99 %. Differences of a city, where
// most runs are single ids, would take 15 to 22 % less over the ids. Giving the middle values the shorter forms gained
// nothing.
//
// Worst list, without the escape: a level of the halving costs at most d = s_n - n bits, as ceil(lg(d + 1)) <= d sums up over
// its parts, and there are ceil(lg n) levels. Where all numbers are 1 but one, which is 2, that many bits may be needed.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "codecs/entropy/list_bits.h"

namespace vismat {

/// A code for PairRows (pairs.h).
class InterpolativeCode {
 public:
  /// Appends a list; numbers of at least 1, in all at most 2^56.
  void put(std::vector<std::byte>& out, std::span<const std::uint32_t> numbers);
  class Reader {
   public:
    Reader(const InterpolativeCode&, std::span<const std::byte> bytes);
    std::size_t read(std::span<std::uint32_t> out);

   private:
    struct Known {
      std::uint32_t place = 0;
      std::uint64_t sum = 0;
    };
    ListBits bits_;
    Known last_;                   // of what was read
    std::array<Known, 33> ahead_;  // what is known behind it, the nearest on top
    std::size_t height_ = 0;
  };

 private:
  std::vector<std::uint64_t> sums_;
};

}  // namespace vismat
