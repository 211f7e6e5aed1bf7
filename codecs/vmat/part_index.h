// The index: where the parts of a payload begin. It is an ascending list of places in about 2.1 + log2(payload bytes /
// parts) bits each [Elias 1974, Fano 1971], and any place is read alone. A payload is a model, often empty, and behind
// it its parts.
//
//   varint    n, the number of parts; nothing follows if there are none, or all are equally long and there is no model
//
// Otherwise there follow n + 1 places: where the parts begin, and where the last one ends, which is u, the payload's
// length in bytes:
//
//   samples   for each of the places 256, 512, ...: the position of its bit in `high`; 4 bytes each, 8 if `high` has 2^32 bits or more
//   high      n + 1 + (u >> b) bits: for place i, which is s, bit (s >> b) + i is 1
//   low       (n + 1) b bits: the b lowest bits of each s
//
// Codecs that are read every frame trade bytes for time: a plain index, by which a part is found by one load, is
//
//   byte      0
//   places    n + 1 places of 4 bytes each, where n > 0
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

#include "codecs/entropy/bit_stream.h"
#include "matrix/base/byte_reader.h"
#include "matrix/base/simd.h"

namespace vismat {

enum class IndexForm { small, plain };

/// The index of parts that begin at `starts`, ascending; the last one ends with the payload. A payload of 2^32 bytes or
/// more has no plain index.
std::vector<std::byte> part_index_bytes(std::span<const std::uint64_t> starts, std::uint64_t payload_bytes,
                                        IndexForm form = IndexForm::small);

/// Reads single places from borrowed bytes. If these are damaged a result may be wrong, but it lies within the payload,
/// and no byte outside the index is read.
class PartIndex {
 public:
  PartIndex() = default;
  /// Reads only the first few bytes, after touch(those). `simd`: what part() may use to find the same places. Throws
  /// FormatError unless there are exactly as many bytes as the parts take.
  template <typename Touch>
  PartIndex(std::span<const std::byte> index, std::uint64_t payload_bytes, const Touch& touch,
            Simd simd = best_simd())
      : simd_(simd), payload_bytes_(payload_bytes) {
    open(touch(index.first(std::min<std::size_t>(index.size(), 10))), index);
  }
  /// Throws FormatError unless these are exactly the bytes that part_index_bytes gives for some places. O(parts).
  void check_whole() const;

  std::uint64_t parts() const { return parts_; }
  struct Place {
    std::uint64_t begin, end;
  };
  /// The place of part i < parts(). Calls touch(bytes) for the bytes of the index before it reads them.
  template <typename Touch>
  [[gnu::always_inline]] Place part(std::uint64_t i, const Touch& touch) const {
    if (!plain_.empty()) {
      const auto both = number_at<std::uint64_t>(touch(plain_.subspan(4 * i, 8)), 0);
      const std::uint64_t begin = both & 0xffffffff, end = both >> 32;
      if (begin > end || end > payload_bytes_) [[unlikely]]
        refuse();
      return {begin, end};
    }
    return part_of_small(i, touch);
  }
  template <typename Touch>
  std::uint64_t model_bytes(const Touch& touch) const {
    if (equal_bytes_) return parts_ == 0 ? payload_bytes_ : 0;
    return part(0, touch).begin;
  }

 private:
  static constexpr std::uint64_t sample_step = 256;
  friend std::vector<std::byte> part_index_bytes(std::span<const std::uint64_t>, std::uint64_t, IndexForm);
  struct Layout {
    Layout(std::uint64_t parts, std::uint64_t payload_bytes);
    unsigned low_bits;
    std::uint64_t samples, sample_bytes, high_bits, low_bytes;
    std::uint64_t bytes() const { return samples * sample_bytes + (high_bits + 7) / 8 + low_bytes; }
  };
  void open(std::span<const std::byte> head, std::span<const std::byte> index);
  template <typename Touch>
  Place part_of_small(std::uint64_t i, const Touch& touch) const {
    if (equal_bytes_) return {i * *equal_bytes_, (i + 1) * *equal_bytes_};
#if defined(__x86_64__)
    if (simd_ != Simd::none) return find_avx2(i, touch);
#endif
    return find(
        i, touch, [](std::uint64_t word) { return ones_up_to_bytes(word) >> 56; }, from_one);
  }
  [[noreturn]] static void refuse() {
    throw FormatError("the index of the parts is damaged");
  }

  // The place of part i; ones_in(word) counts ones, behind(word, skip) is the word without its first `skip` ones.
  // Where the places lie as densely as usual, the eight words that follow a sample are looked at without a branch, as
  // it would be guessed wrong for most parts.
  template <typename Touch, typename Count, typename From>
  [[gnu::always_inline]] Place find(std::uint64_t i, const Touch& touch, const Count& ones_in,
                                    const From& from_one_on) const {
    const std::uint64_t at = i < sample_step ? 0 : sample(i / sample_step - 1, touch);
    Words words{high_, at / 64};
    std::uint64_t bits = words.first(touch) & ~std::uint64_t{0} << (at % 64), skip = i % sample_step;
    if (words.eight_more(touch)) {
      std::uint64_t passed = 0, ones = ones_in(bits), whole = 0;
      for (std::uint64_t w = 1; w <= 8; ++w) {
        const bool pass = ones <= skip;
        whole = pass ? w : whole;
        passed = pass ? ones : passed;
        if (w < 8) ones += ones_in(words.ahead(w));
      }
      if (whole > 0) bits = words.skip(whole, touch);
      skip -= passed;
    }
    for (std::uint64_t ones = ones_in(bits); ones <= skip; ones = ones_in(bits)) {
      skip -= ones;
      bits = words.next(touch);
    }
    bits = from_one_on(bits, skip);
    const std::uint64_t first = words.place(bits);
    bits &= bits - 1;
    while (bits == 0) bits = words.next(touch);
    const auto [begin, end] = numbers(first, words.place(bits), i, touch);
    if (begin > end || end > payload_bytes_) [[unlikely]]
      refuse();
    return {begin, end};
  }
#if defined(__x86_64__)
  [[gnu::target("popcnt")]] static std::uint64_t ones_by_popcnt(std::uint64_t word) {
    return static_cast<std::uint64_t>(__builtin_popcountll(word));
  }
  [[gnu::target("bmi2")]] static std::uint64_t from_one_by_bmi2(std::uint64_t word, std::uint64_t skip) {
    return __builtin_ia32_pdep_di(~std::uint64_t{0} << skip, word);
  }
  template <typename Touch>
  [[gnu::target("avx2,bmi,bmi2,popcnt")]] Place find_avx2(std::uint64_t i, const Touch& touch) const {
    return find(i, touch, ones_by_popcnt, from_one_by_bmi2);
  }
#endif

  // Byte b gets the number of ones in bytes 0 to b.
  static std::uint64_t ones_up_to_bytes(std::uint64_t word) {
    word -= word >> 1 & 0x5555555555555555;
    word = (word & 0x3333333333333333) + (word >> 2 & 0x3333333333333333);
    return ((word + (word >> 4)) & 0x0f0f0f0f0f0f0f0f) * 0x0101010101010101;
  }
  // The word without its first `skip` ones; it must have more. Goes by whole bytes [Vigna 2008, broadword selection].
  static std::uint64_t from_one(std::uint64_t word, std::uint64_t skip) {
    constexpr std::uint64_t lowest = 0x0101010101010101, highest = 0x8080808080808080;
    const std::uint64_t ones = ones_up_to_bytes(word);
    const std::uint64_t passed =
        ((skip * lowest | highest) - ones) & highest;  // bytes up to which there are at most `skip`
    const auto bytes = static_cast<unsigned>((passed >> 7) * lowest >> 56);
    skip -= (ones << 8) >> (8 * bytes) & 0xff;
    word = word >> (8 * bytes) << (8 * bytes);
    for (; skip > 0; --skip) word &= word - 1;
    return word;
  }
  template <typename Touch>
  std::uint64_t sample(std::uint64_t i, const Touch& touch) const {
    const auto bytes = touch(samples_.subspan(i * sample_bytes_, sample_bytes_));
    std::uint64_t place = 0;
    std::memcpy(&place, bytes.data(), bytes.size());
    return place;
  }
  // `high` word by word. Eight words at a time are announced to touch(); behind the last bit there are zeros.
  struct Words {
    std::span<const std::byte> high;
    std::uint64_t index;
    template <typename Touch>
    std::uint64_t first(const Touch& touch) {
      if (index >= (high.size() + 7) / 8) [[unlikely]]
        refuse();
      touch(high.subspan(8 * index, std::min(8 * (8 - index % 8), high.size() - 8 * index)));
      return word();
    }
    template <typename Touch>
    std::uint64_t next(const Touch& touch) {
      ++index;
      return index % 8 == 0 ? first(touch) : word();
    }
    // Whether eight words from this one on are in the bytes.
    template <typename Touch>
    bool eight_more(const Touch& touch) const {
      if (8 * index + 64 > high.size()) return false;
      touch(high.subspan(8 * index, 64));
      return true;
    }
    // The word `count` < 8 behind this one, of eight.
    std::uint64_t ahead(std::uint64_t count) const {
      return number_at<std::uint64_t>(high, 8 * (index + count));
    }
    template <typename Touch>
    std::uint64_t skip(std::uint64_t count, const Touch& touch) {
      index += count;
      return first(touch);
    }
    std::uint64_t place(std::uint64_t bits) const {
      return 64 * index + static_cast<std::uint64_t>(std::countr_zero(bits));
    }

   private:
    std::uint64_t word() const { return 8 * index < high.size() ? word_at(high, 8 * index) : 0; }
  };
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

  // Numbers i and i + 1.
  template <typename Touch>
  [[gnu::always_inline]] Place numbers(std::uint64_t place, std::uint64_t next_place, std::uint64_t i,
                                       const Touch& touch) const {
    const std::uint64_t bit = i * low_bits_, byte = bit / 8;
    if (2 * low_bits_ > 57 || byte + 8 > low_.size()) [[unlikely]]
      return {number(place, i, touch), number(next_place, i + 1, touch)};
    const std::uint64_t both = number_at<std::uint64_t>(touch(low_.subspan(byte, 8)), 0) >> (bit % 8),
                        mask = (std::uint64_t{1} << low_bits_) - 1;
    return {(place - i) << low_bits_ | (both & mask),
            (next_place - i - 1) << low_bits_ | (both >> low_bits_ & mask)};
  }

  Simd simd_ = Simd::none;
  std::uint64_t parts_ = 0, payload_bytes_ = 0;
  std::optional<std::uint64_t> equal_bytes_ = 0;
  unsigned low_bits_ = 0;
  std::uint64_t sample_bytes_ = 0;
  std::span<const std::byte> index_, plain_, samples_, high_, low_;
};

}  // namespace vismat
