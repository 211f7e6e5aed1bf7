// Canonical Huffman codes of at most 15 bits.
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "codecs/bit_stream.h"

namespace vismat {

class HuffmanCode {
 public:
  static constexpr unsigned longest = 15;

  HuffmanCode() = default;
  /// One frequency a symbol, at most 2^15 symbols; a symbol of frequency 0 gets no code. Ties break by
  /// symbol, so the same frequencies give the same code.
  static HuffmanCode from_frequencies(std::span<const std::uint64_t> frequencies);

  void put(BitWriter& out, std::uint32_t symbol) const { out.put(codes_[symbol], lengths_[symbol]); }
  /// Throws FormatError on bits that are no symbol's.
  std::uint32_t get(BitReader& in) const;

  /// The code itself: runs of equal code lengths, 4 bits a length and 4 a run, ended by the symbol count.
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
