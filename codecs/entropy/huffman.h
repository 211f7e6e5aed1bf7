// Canonical Huffman codes of at most 15 bits.
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "codecs/entropy/bit_stream.h"

namespace vismat {

/// The length of the longest code.
constexpr unsigned longest_huffman = 15;

/// Replaces two or more ascending weights by the depths of their leaves in Huffman's tree; the first is the deepest.
void huffman_depths(std::span<std::uint64_t> weights);

/// A canonical code is stored as its lengths: bytes with a length in the low 4 bits and the number of further symbols
/// that have it in the high 4.
void put_code_lengths(std::vector<std::byte>& out, std::span<const std::uint8_t> lengths);
/// Calls each(first, run, length) for runs of symbols until all `symbols` have a length. Throws FormatError unless the
/// code is complete, or of one symbol, or of none.
template <typename Each>
void read_code_lengths(ByteReader& in, std::uint32_t symbols, const Each& each) {
  std::uint32_t told = 0, space = 0, used = 0;  // space: of 2^15 codes
  while (told < symbols) {
    const auto byte = in.number<std::uint8_t>();
    const unsigned length = byte & 15, run = (byte >> 4) + 1u;
    if (run > symbols - told) in.fail("more Huffman code lengths than symbols");
    each(told, run, length);
    told += run;
    if (length > 0) space += run << (longest_huffman - length), used += run;
    if (space > 1u << longest_huffman) in.fail("Huffman code lengths claim more codes than there are");
  }
  if (used > 1 && space != 1u << longest_huffman) in.fail("the Huffman code is incomplete");
}

/// The low `count` <= 16 bits in reverse order: codes are stored from their highest bit on.
constexpr unsigned reversed_code(unsigned code, unsigned count) {
  code = (code & 0x5555) << 1 | (code >> 1 & 0x5555);
  code = (code & 0x3333) << 2 | (code >> 2 & 0x3333);
  code = (code & 0x0f0f) << 4 | (code >> 4 & 0x0f0f);
  code = (code & 0x00ff) << 8 | code >> 8;
  return code >> (16 - count);
}

class HuffmanCode {
 public:
  HuffmanCode() = default;
  /// One frequency for each symbol, at most 2^15 symbols; a symbol of frequency 0 gets no code. Ties are broken by
  /// symbol, so the same frequencies give the same code.
  static HuffmanCode from_frequencies(std::span<const std::uint64_t> frequencies);

  void put(BitWriter& out, std::uint32_t symbol) const { out.put(codes_[symbol], lengths_[symbol]); }
  /// Throws FormatError on bits that are no symbol's code.
  std::uint32_t get(BitReader& in) const;

  /// Writes the code: runs of equal code lengths, 4 bits for a length and 4 for its run. The reader must know the
  /// number of symbols.
  void write(std::vector<std::byte>& out) const;
  static HuffmanCode read(ByteReader& in, std::uint32_t symbols);  // FormatError unless complete

 private:
  void assign_codes();
  std::vector<std::uint8_t> lengths_;  // 0: no code
  std::vector<std::uint16_t> codes_;   // bit-reversed: the first bit of the code is the lowest
  std::vector<std::uint32_t> table_;   // the next `width_` bits -> symbol << 4 | length
  unsigned width_ = 0;
};

}  // namespace vismat
