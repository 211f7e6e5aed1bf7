// The row codec `rows-fast-bits`: the bytes in which a row's bits differ from those of a leader that four rows share. It is
// for engines that take rows as bits. fast_bits.cpp says why it is as it is.
//
// A part holds four rows, and bits that they have in common, the *leader*, which need be no row. Bits are cut into words
// of 64; W is the number of words of a row.
//
//   leader   W / 8 bytes, rounded up: *levels*, a bit for each word: whether it has a mask
//            as many bytes: *fills*, a bit for each word: what its bytes are made of that are not stored
//            masks: for each word that has one a byte, whose bit i says whether byte i of the word is stored
//            values: the bytes that are stored
//   rows     for each the bits in which it differs from the leader, as the leader's, but without fills, which are all 0;
//            or, where these take no fewer bytes, its bitmap
//   ends     where the leader and each of the four rows end in the part, 2 bytes each; 4 if five bitmaps have 65536 bytes or more
//
// A leader or a row without any bit takes no bytes; nor do rows behind the matrix.
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "codecs/rows/row_codec.h"
#include "matrix/base/simd.h"

namespace vismat {

/// A row codec (row_codec.h).
class FastBitRows {
 public:
  static constexpr std::uint32_t rows_per_part = 4;
  static constexpr IndexForm index_form = IndexForm::plain;
  static constexpr bool writes_all_words = true;
  static FastBitRows fit(const VisibilityMatrix&) { return {}; }
  void write_model(std::vector<std::byte>&) const {}
  static FastBitRows read_model(ByteReader&, Shape) { return {}; }
  void encode_part(const VisibilityMatrix& matrix, std::uint32_t first, std::uint32_t end,
                   std::vector<std::byte>& out) const;

  template <typename Sink>
  void decode(std::span<const std::byte> part, std::uint32_t row, RowScratch& scratch, Sink& sink) const {
    const Streams streams = streams_of(part, row, sink.columns());
    if (streams.own.size() == row_bytes_of(sink.columns())) return get_bitmap_row(streams.own, sink);
    if constexpr (std::is_same_v<Sink, BitSink>) {
      sink.words([&](std::span<std::uint64_t> words) { write_words(streams, sink.columns(), words); });
    } else {
      auto& words = scratch.as<std::vector<std::uint64_t>>();
      words.resize((std::size_t{sink.columns()} + 63) / 64);
      write_words(streams, sink.columns(), words);
      get_bitmap_row(std::as_bytes(std::span(words)).first(row_bytes_of(sink.columns())), sink);
    }
  }
  Simd simd = best_simd();

 private:
  // In a part, which reaches eight bytes or more behind both.
  struct Streams {
    std::span<const std::byte> leader, own;
  };
  static constexpr std::size_t bytes_of_ends(std::uint32_t columns) {
    return 5 * row_bytes_of(columns) < 65536 ? 2 : 4;
  }
  static Streams streams_of(std::span<const std::byte> part, std::uint32_t row, std::uint32_t columns) {
    return bytes_of_ends(columns) == 2 ? streams_of<std::uint16_t>(part, row, columns)
                                       : streams_of<std::uint32_t>(part, row, columns);
  }
  template <typename End>
  static Streams streams_of(std::span<const std::byte> part, std::uint32_t row, std::uint32_t columns) {
    constexpr std::size_t size = (1 + rows_per_part) * sizeof(End);
    const std::size_t bytes = part.size() - size;  // if there are any
    if (part.size() < size) [[unlikely]]
      refuse_part(part.size());
    const std::size_t leader = number_at<End>(part, bytes),
                      begin = number_at<End>(part, bytes + row * sizeof(End)),
                      end = number_at<End>(part, bytes + (row + 1) * sizeof(End));
    if (leader > bytes || begin > end || end > bytes || end - begin > row_bytes_of(columns)) [[unlikely]]
      refuse_part(part.size());
    return {part.first(leader), part.subspan(begin, end - begin)};
  }
  [[noreturn]] static void refuse_part(std::size_t bytes) {
    throw FormatError("four rows in " + std::to_string(bytes) +
                      " bytes, whose ends do not ascend within them");
  }
  // Throws FormatError unless the streams are bits of so many columns.
  void write_words(const Streams& streams, std::uint32_t columns, std::span<std::uint64_t> words) const;
};

}  // namespace vismat
