// Where the parts of a payload lie: an ascending list of places, any of which is read alone, in about 2.1 + log2(payload bytes /
// parts) bits each [Elias 1974, Fano 1971]. A payload is a model, often empty, and behind it its parts.
//
//   varint    n, how many parts; nothing follows if all are equally long and there is no model
//
// and otherwise the n + 1 places where the parts begin and the last ends, which is u, the payload's bytes:
//
//   samples   of the places 256, 512, ...: where the place's bit stands in `high`; 4 bytes each, 8 if `high` has 2^32 bits or more
//   high      n + 1 + (u >> b) bits: for place i, which is s, bit (s >> b) + i is 1
//   low       (n + 1) b bits: the b lowest bits of each s
#pragma once
#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "codecs/bit_stream.h"
#include "matrix/byte_reader.h"

namespace vismat {

/// Parts begin at `starts`, ascending, and the last ends with the payload.
std::vector<std::byte> part_index_bytes(std::span<const std::uint64_t> starts, std::uint64_t payload_bytes);

/// Reads single places out of borrowed bytes, whatever these hold: a result may be wrong where the bytes are, but none lies
/// outside the payload and no read outside the bytes.
class PartIndex {
 public:
  PartIndex() = default;
  /// Reads the first few bytes alone, after touch(those). Throws FormatError unless there are exactly as many bytes as the parts take.
  template <typename Touch>
  PartIndex(std::span<const std::byte> index, std::uint64_t payload_bytes, const Touch& touch)
      : payload_bytes_(payload_bytes) {
    open(touch(index.first(std::min<std::size_t>(index.size(), 10))), index);
  }
  /// Throws FormatError unless these are the very bytes that part_index_bytes gives for some places. O(parts).
  void check_whole() const;

  std::uint64_t parts() const { return parts_; }
  struct Place {
    std::uint64_t begin, end;
  };
  /// Of part i < parts(). touch(bytes) is told of the index's bytes before they are read.
  template <typename Touch>
  Place part(std::uint64_t i, const Touch& touch) const {
    if (equal_bytes_) return {i * *equal_bytes_, (i + 1) * *equal_bytes_};
    std::uint64_t at = i < sample_step ? 0 : sample(i / sample_step - 1, touch);
    std::uint64_t bits = high(at, touch);
    auto skip = static_cast<int>(i % sample_step);
    for (int ones = std::popcount(bits); ones <= skip; ones = std::popcount(bits)) {
      skip -= ones;
      at += 64;
      bits = high(at, touch);
    }
    for (; skip > 0; --skip) bits &= bits - 1;
    const std::uint64_t first = at + static_cast<std::uint64_t>(std::countr_zero(bits));
    bits &= bits - 1;
    while (bits == 0) {
      at += 64;
      bits = high(at, touch);
    }
    const std::uint64_t second = at + static_cast<std::uint64_t>(std::countr_zero(bits));
    const std::uint64_t begin = number(first, i, touch), end = number(second, i + 1, touch);
    if (begin > end || end > payload_bytes_) [[unlikely]]
      refuse();
    return {begin, end};
  }
  template <typename Touch>
  std::uint64_t model_bytes(const Touch& touch) const {
    if (equal_bytes_) return parts_ == 0 ? payload_bytes_ : 0;
    return part(0, touch).begin;
  }

 private:
  static constexpr std::uint64_t sample_step = 256;
  friend std::vector<std::byte> part_index_bytes(std::span<const std::uint64_t>, std::uint64_t);
  struct Layout {
    Layout(std::uint64_t parts, std::uint64_t payload_bytes);
    unsigned low_bits;
    std::uint64_t samples, sample_bytes, high_bits, low_bytes;
    std::uint64_t bytes() const { return samples * sample_bytes + (high_bits + 7) / 8 + low_bytes; }
  };
  void open(std::span<const std::byte> head, std::span<const std::byte> index);
  [[noreturn]] static void refuse() { throw FormatError("the index of the parts is damaged"); }

  template <typename Touch>
  std::uint64_t sample(std::uint64_t i, const Touch& touch) const {
    const auto bytes = touch(samples_.subspan(i * sample_bytes_, sample_bytes_));
    std::uint64_t place = 0;
    std::memcpy(&place, bytes.data(), bytes.size());
    return place;
  }
  // 64 bits from bit `at` on, zeros behind the last.
  template <typename Touch>
  std::uint64_t high(std::uint64_t at, const Touch& touch) const {
    if (at >= high_bits_) [[unlikely]]
      refuse();
    const std::uint64_t byte = at / 8, count = std::min<std::uint64_t>(9, high_.size() - byte);
    const auto bytes = touch(high_.subspan(byte, count));
    const auto shift = static_cast<unsigned>(at % 8);
    std::uint64_t word = word_at(bytes, 0) >> shift;
    if (shift > 0 && count == 9) word |= std::to_integer<std::uint64_t>(bytes[8]) << (64 - shift);
    return word;
  }
  template <typename Touch>
  std::uint64_t number(std::uint64_t place, std::uint64_t i, const Touch& touch) const {
    const std::uint64_t upper = (place - i) << low_bits_;
    if (low_bits_ == 0) return upper;
    const std::uint64_t bit = i * low_bits_, byte = bit / 8, last = (bit + low_bits_ - 1) / 8;
    const auto bytes = touch(low_.subspan(byte, last - byte + 1));
    const auto shift = static_cast<unsigned>(bit % 8);
    std::uint64_t word = word_at(bytes, 0) >> shift;
    if (bytes.size() > 8) word |= std::to_integer<std::uint64_t>(bytes[8]) << (64 - shift);
    return upper | (word & ((std::uint64_t{1} << low_bits_) - 1));
  }

  std::uint64_t parts_ = 0, payload_bytes_ = 0;
  std::optional<std::uint64_t> equal_bytes_ = 0;
  unsigned low_bits_ = 0;
  std::uint64_t high_bits_ = 0, sample_bytes_ = 0;
  std::span<const std::byte> index_, samples_, high_, low_;
};

}  // namespace vismat
