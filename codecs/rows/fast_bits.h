// The row codec `rows-fast-bits`: where a row's bits change, byte by byte, against the changes that four rows have in
// common. It is for engines that take rows as bits. fast_bits.cpp says why it is as it is.
//
// A row's *changes* are as many bits as it has: bit c says whether column c differs from column c - 1 (from 0 for column
// 0). A part holds four rows, and changes that they have in common, the *leader*, which need be no row's.
//
//   varints  the bytes of the leader, and of each of the four rows; 0 for rows behind the matrix
//   leader   its changes
//   rows     for each row the changes in which it differs from the leader; or, where these take no fewer bytes, its bitmap
//
// Changes take no bytes if there are none. Otherwise, with the bits cut into words of 64:
//
//   levels   a bit for each word, padded with zeros to bytes: whether it has changes
//   masks    for each word that has: a byte, whose bit i says whether byte i of the word has changes
//   values   for each byte that has: the byte
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>
#include <vector>

#include "codecs/rows/row_codec.h"
#include "matrix/base/simd.h"

namespace vismat {

/// A row codec (row_codec.h).
class FastBitRows {
 public:
  static constexpr std::uint32_t rows_per_part = 4;
  static FastBitRows fit(const VisibilityMatrix&) { return {}; }
  void write_model(std::vector<std::byte>&) const {}
  static FastBitRows read_model(ByteReader&, Shape) { return {}; }
  void encode_part(const VisibilityMatrix& matrix, std::uint32_t first, std::uint32_t end,
                   std::vector<std::byte>& out) const;

  template <typename Sink>
  void decode(std::span<const std::byte> part, std::uint32_t row, RowScratch& scratch, Sink& sink) const {
    const Streams streams = streams_of(part, row, sink.columns());
    if (streams.bitmap) return get_bitmap_row(streams.own, sink);
    if constexpr (std::is_same_v<Sink, BitSink>) {
      sink.words([&](std::span<std::uint64_t> words) { add_changes(streams, sink.columns(), words); });
    } else {
      auto& words = scratch.as<std::vector<std::uint64_t>>();
      words.assign((std::size_t{sink.columns()} + 63) / 64, 0);
      add_changes(streams, sink.columns(), words);
      get_bitmap_row(std::as_bytes(std::span(words)).first(row_bytes_of(sink.columns())), sink);
    }
  }
  Simd simd = best_simd();

 private:
  struct Streams {
    std::span<const std::byte> leader, own;
    bool bitmap;  // `own` is the row's bitmap
  };
  static Streams streams_of(std::span<const std::byte> part, std::uint32_t row, std::uint32_t columns);
  // Turns zeros into the row. Throws FormatError unless the streams are changes of so many columns.
  void add_changes(const Streams& streams, std::uint32_t columns, std::span<std::uint64_t> words) const;
};

}  // namespace vismat
