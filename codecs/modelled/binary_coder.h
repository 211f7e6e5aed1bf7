// A range coder for bits of given probability and numbers of even chances, fast to read: 64 bits of state, refilled four
// bytes at a time [Martin 1979].
#pragma once
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "codecs/entropy/range_coder.h"
#include "matrix/base/byte_reader.h"

namespace vismat {

/// Appends to `out`. `low` is 64 bits of the code value that are not yet sent; `range` is at least 2^32 between calls.
class BinaryWriter {
 public:
  static constexpr bool reads = false;
  explicit BinaryWriter(std::vector<std::byte>& out) : out_(out), begin_(out.size()) {}
  /// A bit that is 1 with probability ones / 2^16, 0 < ones < 2^16.
  void put_bit(bool bit, std::uint32_t ones) {
    const std::uint64_t bound = (range_ >> 16) * ones;
    if (bit)
      range_ = bound;
    else
      narrow(bound, range_ - bound);
    renew();
  }
  /// One of `count` equally likely values; 0 < count < 2^32.
  void put_even(std::uint32_t count, std::uint32_t value) { put_span(count, value, 1); }
  /// That it is one of the `size` values from `first` on.
  void put_span(std::uint32_t count, std::uint32_t first, std::uint32_t size) {
    const std::uint64_t unit = range_ / count;
    narrow(unit * first, unit * size);
    renew();
  }
  /// Ends with the fewest bytes that identify the final range: the reader supplies the zeros behind them.
  void finish();

 private:
  void narrow(std::uint64_t start, std::uint64_t size) {
    low_ += start;
    if (low_ < start) carry_into(out_, begin_);
    range_ = size;
  }
  void renew() {
    while (range_ < std::uint64_t{1} << 32) {
      for (unsigned shift = 56; shift >= 32; shift -= 8)
        out_.push_back(static_cast<std::byte>(low_ >> shift));
      low_ <<= 32;
      range_ <<= 32;
    }
  }
  std::vector<std::byte>& out_;
  std::size_t begin_;
  std::uint64_t low_ = 0, range_ = ~std::uint64_t{0};
};

class BinaryReader {
 public:
  static constexpr bool reads = true;
  BinaryReader() = default;
  explicit BinaryReader(std::span<const std::byte> bytes) : bytes_(bytes) {
    code_ = std::uint64_t{four()} << 32;
    code_ |= four();
  }
  bool bit(std::uint32_t ones) {
    const std::uint64_t bound = (range_ >> 16) * ones;
    const bool one = code_ < bound;
    const std::uint64_t rest = range_ - bound, past = code_ - bound;
    range_ = one ? bound : rest;
    code_ = one ? code_ : past;
    renew();
    return one;
  }
  /// Throws FormatError where no value stands.
  std::uint32_t even(std::uint32_t count) {
    const std::uint32_t value = aim(count);
    take(value, 1);
    return value;
  }
  /// One of the values that a span has; take() with that span must follow. Throws FormatError where no value stands.
  std::uint32_t aim(std::uint32_t count) {
    unit_ = std::has_single_bit(count) ? range_ >> std::countr_zero(count) : range_ / count;
    const std::uint64_t value = code_ / unit_;
    if (value >= count) [[unlikely]]
      refuse();
    return static_cast<std::uint32_t>(value);
  }
  void take(std::uint32_t first, std::uint32_t size) {
    code_ -= first * unit_;
    range_ = unit_ * size;
    renew();
  }
  /// Throws FormatError unless the bytes are those with which a writer ends after what was read.
  void finish() const;

 private:
  void renew() {
    while (range_ < std::uint64_t{1} << 32) [[unlikely]] {
        code_ = code_ << 32 | four();
        range_ <<= 32;
      }
  }
  std::uint32_t four() {
    std::uint32_t value = 0;
    for (int i = 0; i < 4; ++i, ++next_)
      value = value << 8 | (next_ < bytes_.size() ? std::to_integer<std::uint32_t>(bytes_[next_]) : 0);
    return value;
  }
  [[noreturn]] static void refuse();
  std::span<const std::byte> bytes_;
  std::size_t next_ = 0;
  std::uint64_t code_ = 0, range_ = ~std::uint64_t{0}, unit_ = 0;
};

}  // namespace vismat
