// Binary interpolative coding [Moffat, Stuiver 2000] of a list's partial sums. The middle one takes as few bits as
// distinguish the values that are possible between its neighbours; then each half is coded the same way.
//
//   varint   n, the number of numbers; at most 2^32 - 1
//   varint   their sum s_n less n
//   bits     with s_0 = 0: open(0, n). For b - a > 1 and m = floor((a + b) / 2), open(a, b) codes
//            v = s_m - s_a - (m - a), one of r = s_b - s_a - (b - a) + 1 values, then does open(a, m) and open(m, b).
//            With k = ceil(lg r) and u = 2^k - r: nothing if r = 1; v in k - 1 bits if v < u; otherwise floor((v + u) / 2)
//            in k - 1 bits and then the lowest bit of v + u
//
// The partial sums are the places where runs begin and end. Coding the column numbers themselves takes more on levels
// and less on differences of a city (docs/codecs.md). Giving the middle values the shorter codes gained nothing.
//
// The worst list, without the escape: one level of the halving costs at most d = s_n - n bits, as ceil(lg(d + 1)) <= d
// sums up over its parts, and there are ceil(lg n) levels. If all numbers are 1 but one, which is 2, that many bits may
// be needed.
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
  /// Appends a list of numbers of at least 1, with a sum of at most 2^56.
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
    Known last_;                   // about what was read
    std::array<Known, 33> ahead_;  // what is known about the rest, the nearest on top
    std::size_t height_ = 0;
  };

 private:
  std::vector<std::uint64_t> sums_;
};

}  // namespace vismat
