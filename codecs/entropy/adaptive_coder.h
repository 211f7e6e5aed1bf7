// Adaptive coding of bits and numbers over the range coder: the probabilities follow what was coded. The same code
// writes and reads: a coder's functions take a value and return it, and a reader ignores the value that it is given.
#pragma once
#include <array>
#include <bit>
#include <cstdint>
#include <span>
#include <vector>

#include "codecs/entropy/range_coder.h"
#include "matrix/base/byte_reader.h"

namespace vismat {

/// The probability that the next bit is 1: the mean of two estimates, one of which adapts within about 16 bits, the
/// other within 128.
class AdaptiveBit {
 public:
  /// In units of 1 / 2^14; at least 2^6 and at most 2^14 - 2^6. So each bit takes at least 1/180 of a bit, and the
  /// bytes back what is read from them.
  std::uint32_t ones() const {
    const std::uint32_t mean = (std::uint32_t{quick_} + slow_) >> 3;
    return mean < 64 ? 64 : mean > (1u << 14) - 64 ? (1u << 14) - 64 : mean;
  }
  void see(bool bit) {
    move(quick_, bit, 4);
    move(slow_, bit, 7);
  }

 private:
  static void move(std::uint16_t& estimate, bool bit, unsigned shift) {
    if (bit)
      estimate = static_cast<std::uint16_t>(estimate + ((0xffffu - estimate) >> shift));
    else
      estimate = static_cast<std::uint16_t>(estimate - (estimate >> shift));
  }
  std::uint16_t quick_ = 1u << 15, slow_ = 1u << 15;
};

class AdaptiveWriter {
 public:
  static constexpr bool reads = false;
  explicit AdaptiveWriter(std::vector<std::byte>& out) : coder_(out) {}
  bool bit(AdaptiveBit& model, bool value) {
    coder_.put_bit(value, model.ones());
    model.see(value);
    return value;
  }
  bool even_bit(bool value) {
    coder_.put_bit(value, 1u << 13);
    return value;
  }
  void finish() { coder_.finish(); }

 private:
  RangeEncoder coder_;
};

/// Behind the end it reads zeros, which a writer leaves out. The caller bounds what is read, and compares the bytes
/// with those that would be written.
class AdaptiveReader {
 public:
  static constexpr bool reads = true;
  explicit AdaptiveReader(std::span<const std::byte> bytes) : coder_(bytes) {}
  bool bit(AdaptiveBit& model, bool) {
    const bool value = coder_.get_bit(model.ones());
    model.see(value);
    return value;
  }
  bool even_bit(bool) { return coder_.get_bit(1u << 13); }

 private:
  RangeDecoder coder_;
};

/// Codes numbers from 0 to 2^32 - 1. First comes the number of bits of number + 1 below the leading one, in unary; then
/// these bits. The highest three of them have probabilities of their own, the others even chances.
class AdaptiveNumber {
 public:
  template <typename Coder>
  std::uint32_t code(Coder& coder, std::uint32_t number) {
    const std::uint64_t value = std::uint64_t{number} + 1;
    const auto width = static_cast<unsigned>(std::bit_width(value)) - 1;
    unsigned bits = 0;
    while (coder.bit(width_[bits], width > bits)) {
      if (++bits > 32) throw FormatError("a number of more than 32 bits");
    }
    std::uint64_t read = 1;
    for (unsigned b = bits; b-- > 0;) {
      const bool one = (value >> b & 1) != 0;
      read = read << 1 |
             std::uint64_t{bits - b <= 3 ? coder.bit(high_[bits][read & 7], one) : coder.even_bit(one)};
    }
    if (read > 0x100000000u) throw FormatError("a number of more than 32 bits");
    return static_cast<std::uint32_t>(read - 1);
  }

 private:
  std::array<AdaptiveBit, 34> width_;
  std::array<std::array<AdaptiveBit, 8>, 33> high_;
};

}  // namespace vismat
