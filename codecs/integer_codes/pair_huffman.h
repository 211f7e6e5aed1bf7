// Huffman codes for lists of numbers, over the symbols of run_length_symbols.h. Either each list has its own table, as
// in Table 2 of Chhugani et al. 2005, or all lists share one table for gaps and one for runs.
//
//   own table       a byte, one more than the largest symbol, s; the lengths of s symbols as docs/vmat.md says; then
//                   the list: for each number its symbol's code and its raw bits
//   shared tables   the list alone: gaps (even places) and runs (odd places) by their tables; model: both tables
//
// The worst list, without the escape: with its own table 169 bytes and 8 bits for each number, which a code of equal
// lengths for all 168 symbols would take; a shared table may have 15 bits for a number that is rare elsewhere. In both
// cases up to 29 raw bits are added.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "codecs/entropy/huffman.h"
#include "codecs/entropy/list_bits.h"
#include "codecs/entropy/run_length_symbols.h"

namespace vismat {

/// A Huffman code as in huffman.h, of up to LengthSymbol::count symbols and without memory of its own. It takes 4 kB
/// and is made in about a microsecond, so that each row may have one.
class HuffmanTable {
 public:
  HuffmanTable() = default;  // no symbol at all
  /// Writes the lengths of the best code for these counts, as HuffmanCode::write does.
  static void write(std::vector<std::byte>& out, std::span<const std::uint64_t> counts);
  /// Reads the lengths of `symbols` codes. FormatError unless the code is complete, or of one symbol, or of none.
  static HuffmanTable read(ByteReader& in, std::uint32_t symbols);
  /// One symbol and its raw bits.
  void put(ListWriter& out, std::uint32_t number) const;
  std::uint32_t next(ListBits& bits) const;

 private:
  static constexpr unsigned table_bits = 9;
  struct Entry {
    std::uint8_t symbol, length;  // length 0: a longer code, or none
  };
  struct Used {
    std::uint8_t symbol, length;
    std::uint16_t code;  // its first bit is the lowest
  };
  void assign_codes(std::span<Used> used);
  Entry find_long(std::uint64_t ahead) const;

  unsigned width_ = 0;
  std::array<Entry, 1u << table_bits> table_;  // by the next width_ bits
  // Of each length: its first code, as a number, how many there are, and where in by_code_ their symbols begin.
  std::array<std::uint16_t, longest_huffman + 1> first_{}, count_{}, begin_{};
  std::array<std::uint8_t, LengthSymbol::count> by_code_;
  std::array<Used, LengthSymbol::count> of_symbol_;
};

/// Codes for PairRows (pairs.h).
struct OwnHuffmanCode {
  /// Appends a list of numbers of at least 1.
  static void put(std::vector<std::byte>& out, std::span<const std::uint32_t> numbers);
  class Reader {
   public:
    Reader(const OwnHuffmanCode&, std::span<const std::byte> bytes);
    std::size_t read(std::span<std::uint32_t> out);

   private:
    ListBits bits_;
    HuffmanTable table_;
  };
};

/// Codes with a model.
class SharedHuffmanCode {
 public:
  void see(std::span<const std::uint32_t> numbers) { count_symbols(numbers, counts_); }
  void write_model(std::vector<std::byte>& out);
  void read_model(ByteReader& in);
  /// Appends a list that was seen, or one of the same symbols.
  void put(std::vector<std::byte>& out, std::span<const std::uint32_t> numbers) const;
  class Reader {
   public:
    Reader(const SharedHuffmanCode& code, std::span<const std::byte> bytes);
    std::size_t read(std::span<std::uint32_t> out);

   private:
    ListBits bits_;
    std::array<const HuffmanTable*, 2> tables_;  // the first is for the next number
  };

 private:
  SymbolCounts counts_{};
  std::array<HuffmanTable, 2> tables_;
};

}  // namespace vismat
