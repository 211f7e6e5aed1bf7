#include "codecs/clusters/panne_prices.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace vismat {

PannePrices::PannePrices(Counts counts) {
  constexpr double unseen = 1. / 64;  // so that what does not occur yet has a price
  const auto of = [&](PanneNumber kind) -> auto& {
    return counts[static_cast<std::size_t>(kind)];
  };
  // Where there are no clusters yet they have to look likely enough to be begun with.
  if (std::ranges::all_of(of(PanneNumber::cluster_step), [](std::uint64_t n) { return n == 0; })) {
    for (std::uint32_t s = 0; s < LengthSymbol::count; ++s)
      of(PanneNumber::cluster_step)[s] =
          (of(PanneNumber::object_step)[s] + of(PanneNumber::run_step)[s]) / 16;
    of(PanneNumber::rank) = {8, 4, 2, 1};
    of(PanneNumber::lead) = {8, 4, 2, 1};
    of(PanneNumber::heads)[1] = of(PanneNumber::heads)[0] / 16;
  }
  const auto total = [&](std::size_t kind) {
    return static_cast<double>(std::accumulate(counts[kind].begin(), counts[kind].end(), std::uint64_t{0})) +
           unseen * LengthSymbol::count;
  };
  double steps = 0;
  for (std::size_t kind = 0; kind < panne_steps; ++kind) steps += total(kind);
  for (std::size_t kind = 0; kind < panne_numbers; ++kind) {
    const double sum = kind < panne_steps ? steps : total(kind);
    for (std::uint32_t s = 0; s < LengthSymbol::count; ++s) {
      const double bits = std::log2(sum / (static_cast<double>(counts[kind][s]) + unseen));
      of_symbol_[kind][s] = static_cast<std::uint32_t>(std::lround(bits * unit)) +
                            static_cast<std::uint32_t>(raw_bits_of_symbol(s) * unit);
    }
    small_[kind][0] = 0;
    for (std::uint32_t n = 1; n < small_[kind].size(); ++n)
      small_[kind][n] = of_symbol_[kind][symbol_of_length(n).symbol];
  }
}

std::uint64_t PannePrices::of_large(PanneNumber kind, std::uint32_t number) const {
  return of_symbol_[static_cast<std::size_t>(kind)][symbol_of_length(number).symbol];
}

}  // namespace vismat
