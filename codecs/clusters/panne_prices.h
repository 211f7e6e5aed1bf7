// The estimated cost, in bits, of each kind of number in a coded table of clusters.
#pragma once
#include <array>
#include <cstdint>

#include "codecs/entropy/run_length_symbols.h"

namespace vismat {

/// The kinds of numbers. The first four stand in one place, so their shares are of one total.
enum class PanneNumber { object_step, run_step, cluster_step, end, run, rank, lead, heads };
constexpr std::size_t panne_steps = 4, panne_numbers = 8;

/// Prices of numbers, by how often each symbol of each kind occurs.
class PannePrices {
 public:
  static constexpr std::uint64_t unit = 1024;  // the price of a bit
  using Counts = std::array<std::array<std::uint64_t, LengthSymbol::count>, panne_numbers>;

  explicit PannePrices(Counts counts);
  /// Of a number of at least 1.
  std::uint64_t of(PanneNumber kind, std::uint32_t number) const {
    const auto& prices = small_[static_cast<std::size_t>(kind)];
    return number < prices.size() ? prices[number] : of_large(kind, number);
  }

 private:
  std::uint64_t of_large(PanneNumber kind, std::uint32_t number) const;
  std::array<std::array<std::uint32_t, LengthSymbol::count>, panne_numbers> of_symbol_;
  std::array<std::array<std::uint32_t, 512>, panne_numbers> small_;
};

}  // namespace vismat
