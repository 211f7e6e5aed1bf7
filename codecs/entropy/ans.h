// Asymmetric numeral systems with tables (tANS) [Duda 2009], with one table for gaps and one for runs that all lists
// share.
//
// A number is a symbol of run_length_symbols.h and raw bits. A table gives each symbol s a share f of L = 2^11 states.
// Symbols in ascending order take f places each, and place i is state 1283 i mod L. The j-th of a symbol's states in
// ascending order, j from 0 on, has the number t = f + j. With b = 11 - floor(lg t), a decoder in that state has read s
// and goes on to state t 2^b - L plus the next b bits.
//
//   list    11 bits: the first state; for each number the b bits and the raw bits. The table for gaps serves even places,
//           that for runs odd ones. The list ends when the state is 0 and the bits are used up
//   model   for each table: varint n, then n varints, the shares of symbols 0, 1, ... They sum to L, or n is 0
//
// A number may take no bit at all, so the end depends on the state too. It is met only once: no share is all of L,
// hence a number without bits always leads to a lower state, and from state 0 there is none lower. The encoder begins
// at the list's end, in state 0.
//
// There is one state rather than two interleaved ones, as each costs 11 bits in each list; docs/codecs.md has the
// figures.
//
// The worst list, without the escape: a symbol seen once in a million costs 11 bits, and up to 29 raw ones.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "codecs/entropy/list_bits.h"
#include "codecs/entropy/run_length_symbols.h"

namespace vismat {

class AnsTable {
 public:
  static constexpr unsigned state_bits = 11;
  static constexpr std::uint32_t states = 1u << state_bits;
  using Counts = SymbolCounts::value_type;

  AnsTable() : AnsTable(Shares{}) {}
  /// Shares in proportion to the counts, and at least 1 for each symbol that occurs.
  static AnsTable from_counts(const Counts& counts);
  void write(std::vector<std::byte>& out) const;
  /// Throws FormatError unless the shares sum to L or to 0, each below L.
  static AnsTable read(ByteReader& in);

  struct Step {
    std::uint16_t next;
    std::uint8_t bits, symbol;  // LengthSymbol::count where the table is empty
  };
  const Step& step(std::uint32_t state) const { return steps_[state]; }

  struct Bits {
    std::uint64_t bits;
    unsigned count;
  };
  /// Goes from `state` back to the state in which the symbol is read first, and returns the bits that are read between.
  Bits step_back(std::uint32_t& state, std::uint32_t symbol) const {
    const auto [bits_and_threshold, first_place] = back_[symbol];
    const std::uint32_t from = states + state;
    const unsigned count = (from + bits_and_threshold) >> 16;
    state = places_[(from >> count) + first_place];
    return {lowest_bits(from, count), count};
  }

 private:
  using Shares = std::array<std::uint32_t, LengthSymbol::count>;
  explicit AnsTable(const Shares& shares);
  Shares shares_;
  std::vector<Step> steps_;
  // (state + L + bits_and_threshold) / 2^16 is the number of bits that a symbol leaves. The rest of state + L is its
  // number t, and t + first_place, modulo 2^32, is the index of the state in places_.
  struct Back {
    std::uint32_t bits_and_threshold, first_place;
  };
  std::array<Back, LengthSymbol::count> back_;
  std::vector<std::uint16_t> places_;  // the states of the first symbol in ascending order, of the second ...
};

/// A code for PairRows (pairs.h) with a model.
class AnsCode {
 public:
  void see(std::span<const std::uint32_t> numbers) { count_symbols(numbers, counts_); }
  void write_model(std::vector<std::byte>& out);
  void read_model(ByteReader& in);
  /// Appends a list that was seen, or one of the same symbols.
  void put(std::vector<std::byte>& out, std::span<const std::uint32_t> numbers);
  class Reader {
   public:
    Reader(const AnsCode& code, std::span<const std::byte> bytes);
    std::size_t read(std::span<std::uint32_t> out);

   private:
    ListBits bits_;
    std::array<const AnsTable*, 2> tables_;  // the first is for the next number
    std::uint32_t state_ = 0;
  };

 private:
  SymbolCounts counts_{};
  std::array<AnsTable, 2> tables_;
  std::vector<AnsTable::Bits> steps_of_list_;
};

}  // namespace vismat
