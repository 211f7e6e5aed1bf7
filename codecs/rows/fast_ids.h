// The row codec `rows-fast-ids`: a row's runs in whole bytes, which are decoded to column numbers, its ids, without a
// branch that depends on them but for the longest runs. fast_ids.cpp says why it is as it is.
//
// A row is coded as pairs (pairs.h): for each run its gap and its length, each at least 1. A number is a class and up to
// four raw bytes: class k, of 16, stands for base_k plus the raw bytes, lowest first. All rows share the classes, 16 for
// gaps and 16 for lengths.
//
//   model    for gaps, then for lengths: byte n <= 16; for each class a byte, its raw bytes (0, 1, 2 or 4), and a varint, its base >= 1
//   row      for each run the raw bytes of its gap and those of its length; then, from the last run back to the first, a
//            byte each: the class of the gap in the low half, that of the length in the high half
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <type_traits>
#include <vector>

#include "codecs/rows/pairs.h"
#include "codecs/rows/row_codec.h"
#include "matrix/base/simd.h"

namespace vismat {

/// A row codec (row_codec.h).
class FastIdRows {
 public:
  static constexpr bool escapes = true;
  static constexpr IndexForm index_form = IndexForm::plain;
  static FastIdRows fit(const VisibilityMatrix& matrix);
  void write_model(std::vector<std::byte>& out) const;
  static FastIdRows read_model(ByteReader& in, Shape);
  void encode(std::span<const std::uint32_t> ids, std::vector<std::byte>& out);
  template <typename Sink>
  void decode(std::span<const std::byte> bytes, Sink& sink) const {
#if defined(__x86_64__)
    if constexpr (std::is_same_v<Sink, IdSink>) {
      if (simd == Simd::avx512 && decode_avx512(bytes, sink)) return;
    }
    if (simd != Simd::none) return decode_avx2(bytes, sink);
#endif
    decode_with(bytes, sink);
  }
  Simd simd = best_simd();

 private:
  // Numbers from `base` to base + mask. A class that does not exist has a base that no row has room for.
  struct Class {
    std::uint64_t base = std::uint64_t{1} << 32;
    std::uint32_t mask = 0;
    std::uint8_t bytes = 0;
    bool holds(std::uint32_t number) const { return number >= base && number - base <= mask; }
  };
  using Classes = std::array<Class, 16>;
  static Classes classes_for(std::vector<std::uint32_t>& numbers);
  static Class class_of(unsigned bytes, std::uint64_t base);

#if defined(__x86_64__)
  // False, and nothing in the sink, if a number is large, or the bytes are damaged.
  bool decode_avx512(std::span<const std::byte> bytes, IdSink& sink) const;
  template <typename Sink>
  [[gnu::target("avx2,bmi,bmi2,popcnt")]] void decode_avx2(std::span<const std::byte> bytes,
                                                           Sink& sink) const {
    decode_with(bytes, sink);
  }
#endif
  template <typename Sink>
  [[gnu::always_inline]] void decode_with(std::span<const std::byte> bytes, Sink& sink) const {
    if (bytes.empty()) return;
    // Eight bytes are read where raw bytes may begin. Near the row's end they come from a copy with zeros behind it.
    const std::byte *raw = bytes.data(), *code = raw + bytes.size();
    std::array<std::byte, 16> tail{};
    const std::size_t tail_bytes = bytes.size() < 8 ? bytes.size() : 8;
    const std::byte* const tail_begin = code - tail_bytes;
    if (tail_bytes == 8) [[likely]]
      std::memcpy(tail.data(), tail_begin, 8);
    else
      for (std::size_t i = 0; i < tail_bytes; ++i) tail[i] = tail_begin[i];
    std::uint64_t before_first = 1;
    sink.runs([&](std::uint64_t & gap, std::uint64_t & count) __attribute__((always_inline)) {
      if (raw >= code) return false;
      const auto classes = std::to_integer<unsigned>(*--code);
      const Class &of_gap = gaps_[classes & 15], &of_count = lengths_[classes >> 4];
      std::uint64_t word;
      std::memcpy(&word, raw < tail_begin ? raw : tail.data() + (raw - tail_begin), 8);
      gap = of_gap.base + (word & of_gap.mask) - before_first;
      count = of_count.base + (word >> (8 * of_gap.bytes) & of_count.mask);
      raw += of_gap.bytes + of_count.bytes;
      before_first = 0;
      return true;
    });
    if (raw != code) throw FormatError("the row ends within a run");
  }
  void fill_tables();
  Classes gaps_, lengths_;
  // By the class of a gap and of a length: what decode_avx512() looks up.
  struct Tables {
    struct Of {
      alignas(64) std::array<std::uint32_t, 16> bases;
      alignas(16) std::array<std::uint8_t, 16> masks,
          bytes;  // of raw bytes, a bit for each; of the token and raw bytes
    };
    Of gaps, lengths;
  };
  Tables tables_;
  std::vector<std::uint32_t> memory_;  // an encoder's
};

}  // namespace vismat
