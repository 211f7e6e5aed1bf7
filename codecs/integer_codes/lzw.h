// LZW [Welch 1984] over a list's numbers written as varints, with a new dictionary for each list, as in Table 2 of
// Chhugani et al. 2005.
//
// The dictionary begins with the 256 bytes. Each code adds an entry, the bytes that the code stands for and the byte
// after them, up to 4096 entries. A code takes as many bits as distinguish all possible entries: 8 the first, then 9,
// at most 12.
//
// The worst list, without the escape: bytes that repeat no pair, at 12 bits for each byte; a number takes at most 5
// bytes.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "codecs/entropy/list_bits.h"

namespace vismat {

/// A code for PairRows (pairs.h).
class LzwCode {
 public:
  static constexpr unsigned entries = 4096;
  /// Appends a list of numbers of at least 1.
  void put(std::vector<std::byte>& out, std::span<const std::uint32_t> numbers);
  class Reader {
   public:
    Reader(const LzwCode&, std::span<const std::byte> bytes) : bits_(bytes, "LZW", 8) {}
    std::size_t read(std::span<std::uint32_t> out);

   private:
    void expand();
    ListBits bits_;
    unsigned made_ = 256;
    unsigned open_ = 0;            // the entry whose last byte the next code gives; 0: none
    std::uint8_t first_byte_ = 0;  // of the bytes of the last code
    // For each entry from 256 on: the code for all but its last byte, and that byte.
    std::array<std::uint16_t, entries> before_;
    std::array<std::uint8_t, entries> last_;
    // The bytes that the last code stands for, up to the array's end.
    std::array<std::uint8_t, entries> text_;
    std::size_t text_at_ = entries;
    std::uint32_t number_ = 0;
    unsigned shift_ = 0;
  };

 private:
  std::vector<std::byte> text_;
  // A hash table of entries: list << 32 | entry that it extends << 20 | byte << 12 | entry. Slots of other lists are
  // free.
  std::vector<std::uint64_t> slots_;
  std::uint32_t list_ = 0;
};

}  // namespace vismat
