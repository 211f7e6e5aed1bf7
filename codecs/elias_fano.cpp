#include "codecs/elias_fano.h"

#include <cassert>
#include <string>

namespace vismat {

std::vector<std::byte> elias_fano_bytes(std::span<const std::uint64_t> numbers, std::uint64_t largest) {
  const EliasFanoShape shape(numbers.size(), largest);
  std::vector<std::uint64_t> words(shape.bytes() / 8, 0);
  std::uint64_t* const high = words.data() + shape.sample_words;
  std::uint64_t* const low = high + shape.high_words;
  for (std::uint64_t i = 0; i < numbers.size(); ++i) {
    assert(numbers[i] <= largest && (i == 0 || numbers[i] >= numbers[i - 1]));
    const std::uint64_t place = (numbers[i] >> shape.low_bits) + i;
    high[place / 64] |= std::uint64_t{1} << (place % 64);
    if (i % 64 == 0) words[i / 64] = place;
    if (shape.low_bits == 0) continue;
    const std::uint64_t rest = numbers[i] & ((std::uint64_t{1} << shape.low_bits) - 1),
                        bit = i * shape.low_bits;
    low[bit / 64] |= rest << (bit % 64);
    if (bit % 64 + shape.low_bits > 64) low[bit / 64 + 1] |= rest >> (64 - bit % 64);
  }
  const auto bytes = std::as_bytes(std::span(words));
  return {bytes.begin(), bytes.end()};
}

EliasFano::EliasFano(std::span<const std::byte> bytes, std::uint64_t count, std::uint64_t largest)
    : bytes_(bytes), shape_(count, largest) {
  if (bytes.size() != shape_.bytes()) {
    throw FormatError("row index of " + std::to_string(bytes.size()) + " bytes; " + std::to_string(count) +
                      " places up to " + std::to_string(largest) + " take " + std::to_string(shape_.bytes()));
  }
}

}  // namespace vismat
