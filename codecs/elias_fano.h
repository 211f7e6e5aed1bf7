// An ascending list of numbers in about 2 + log2(largest / count) bits each, any of which is read alone
// [Elias 1974, Fano 1971]: the row index of a `.vmat` file.
//
//   samples   u64 for each 64th number: where its bit stands in `high`
//   high      bits in u64 words: for number i the bit (number >> low_bits) + i is 1
//   low       the low_bits lowest bits of each number, packed into u64 words from the lowest bit
#pragma once
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <utility>
#include <vector>

#include "matrix/byte_reader.h"

namespace vismat {

/// How `count` numbers of at most `largest` are laid out; both are known from elsewhere.
struct EliasFanoShape {
  EliasFanoShape(std::uint64_t count, std::uint64_t largest)
      : low_bits(count == 0            ? 63
                 : largest / count < 2 ? 0
                                       : static_cast<unsigned>(std::bit_width(largest / count)) - 1),
        sample_words((count + 63) / 64),
        high_words((count + (largest >> low_bits) + 1 + 63) / 64),
        low_words((count * low_bits + 63) / 64) {}
  std::uint64_t bytes() const { return 8 * (sample_words + high_words + low_words); }
  unsigned low_bits;
  std::uint64_t sample_words, high_words, low_words;
};

/// `numbers` ascend, not strictly, and are at most `largest`.
std::vector<std::byte> elias_fano_bytes(std::span<const std::uint64_t> numbers, std::uint64_t largest);

/// Reads single numbers out of borrowed bytes, whatever these hold: a result may be wrong where the bytes are, no read
/// goes outside them.
class EliasFano {
 public:
  EliasFano() : shape_(0, 0) {}
  /// Throws FormatError unless there are exactly as many bytes as the shape has.
  EliasFano(std::span<const std::byte> bytes, std::uint64_t count, std::uint64_t largest);

  /// Numbers i and i + 1 < count. Before bytes are read, touch(offset, size) is told of them. Throws FormatError where
  /// the bits run out.
  template <typename Touch>
  std::pair<std::uint64_t, std::uint64_t> pair(std::uint64_t i, const Touch& touch) const {
    const std::uint64_t sample = word(i / 64, touch);
    std::uint64_t at = sample / 64;
    std::uint64_t bits = high(at, touch) & ~std::uint64_t{0} << (sample % 64);
    auto skip = static_cast<int>(i % 64);
    for (int ones = std::popcount(bits); ones <= skip; ones = std::popcount(bits)) {
      skip -= ones;
      bits = high(++at, touch);
    }
    for (; skip > 0; --skip) bits &= bits - 1;
    const std::uint64_t first = at * 64 + static_cast<std::uint64_t>(std::countr_zero(bits));
    bits &= bits - 1;
    while (bits == 0) bits = high(++at, touch);
    const std::uint64_t second = at * 64 + static_cast<std::uint64_t>(std::countr_zero(bits));
    return {((first - i) << shape_.low_bits) | low(i, touch),
            ((second - i - 1) << shape_.low_bits) | low(i + 1, touch)};
  }

 private:
  template <typename Touch>
  std::uint64_t word(std::uint64_t index, const Touch& touch) const {
    touch(index * 8, 8);
    std::uint64_t value;
    std::memcpy(&value, bytes_.data() + index * 8, 8);
    return value;
  }
  template <typename Touch>
  std::uint64_t high(std::uint64_t index, const Touch& touch) const {
    if (index >= shape_.high_words) throw FormatError("the row index is damaged");
    return word(shape_.sample_words + index, touch);
  }
  template <typename Touch>
  std::uint64_t low(std::uint64_t i, const Touch& touch) const {
    if (shape_.low_bits == 0) return 0;
    const std::uint64_t first_bit = i * shape_.low_bits,
                        index = shape_.sample_words + shape_.high_words + first_bit / 64;
    const auto shift = static_cast<unsigned>(first_bit % 64);
    std::uint64_t value = word(index, touch) >> shift;
    if (shift + shape_.low_bits > 64) value |= word(index + 1, touch) << (64 - shift);
    return value & ((std::uint64_t{1} << shape_.low_bits) - 1);
  }
  std::span<const std::byte> bytes_;
  EliasFanoShape shape_;
};

}  // namespace vismat
