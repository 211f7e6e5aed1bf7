// Elias' universal codes for lists of numbers [Elias 1975]: no model, short for small numbers.
//
// For a number of n significant bits, that is a 1 and n - 1 bits m below it:
//
//   gamma   n - 1 zeros, a 1, m             2 n - 1 bits
//   delta   n in gamma, m                   n - 1 + 2 floor(lg n) + 1 bits
//
// The worst rows, without the escape: both codes are most costly for the columns that a number covers at the number 2:
// gamma takes 3 bits (2 n - 1 <= 3/2 x for every x of n bits) and delta 4 (at most 2 x). So two zeros, two ones, two
// zeros ... cost 1.5 and 2 bits for each column.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "codecs/entropy/list_bits.h"

namespace vismat {

/// Codes for PairRows (pairs.h).
struct GammaCode {
  /// Appends a list of numbers of at least 1.
  static void put(std::vector<std::byte>& out, std::span<const std::uint32_t> numbers);
  class Reader {
   public:
    Reader(const GammaCode&, std::span<const std::byte> bytes) : bits_(bytes, "gamma code", 1) {}
    std::size_t read(std::span<std::uint32_t> out);

   private:
    ListBits bits_;
  };
};

struct DeltaCode {
  static void put(std::vector<std::byte>& out, std::span<const std::uint32_t> numbers);
  class Reader {
   public:
    Reader(const DeltaCode&, std::span<const std::byte> bytes) : bits_(bytes, "delta code", 1) {}
    std::size_t read(std::span<std::uint32_t> out);

   private:
    ListBits bits_;
  };
};

}  // namespace vismat
