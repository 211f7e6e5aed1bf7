// The row codec `elias-fano`: a row's column numbers, its ids, as one Elias-Fano list [Elias 1974, Fano 1971], in 2 +
// lg(columns / ids) bits for each id.
//
// A row without ids has no bytes. Otherwise, with n ids and l = floor(lg floor(columns / n)), or 0 where that is 0:
//
//   varint   n
//   bytes    ceil(n l / 8): the l low bits of each id, padded with zeros
//   bytes    bit (id_i >> l) + i is 1 for each id, the others 0; ends with the byte of the last 1
//
// The worst row, without the escape: l is at most lg(columns / n), so the low bits and the second part's ones and zeros
// are at most n l + n + (columns >> l) <= n (lg(columns / n) + 3) bits; if l = 0 they are n + columns, which is 2 bits
// for each column in a full row.
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "codecs/entropy/elias_fano.h"
#include "codecs/entropy/list_bits.h"
#include "codecs/rows/row_codec.h"

namespace vismat {

/// Rows for row_codec (row_codec.h).
struct EliasFanoRows {
  static constexpr bool escapes = true;
  std::uint32_t columns;
  static EliasFanoRows fit(const VisibilityMatrix& matrix) { return {matrix.shape().columns}; }
  void write_model(std::vector<std::byte>&) const {}
  static EliasFanoRows read_model(ByteReader&, Shape shape) { return {shape.columns}; }
  void encode(std::span<const std::uint32_t> ids, std::vector<std::byte>& out) const;

  template <typename Sink>
  void decode(std::span<const std::byte> bytes, Sink& sink) const {
    if (bytes.empty()) return;
    ByteReader in(bytes, "Elias-Fano row");
    const std::uint64_t count = in.varint();
    if (count == 0 || count > columns)
      in.fail(std::to_string(count) + " ids in a row of " + std::to_string(columns));
    const unsigned low_bits = elias_fano_low_bits(count, columns);
    const std::size_t low_begin = in.offset();
    in.skip((count * low_bits + 7) / 8);
    if (const auto used = static_cast<unsigned>(count * low_bits % 8);
        used != 0 && std::to_integer<unsigned>(bytes[in.offset() - 1]) >> used != 0)
      in.fail("padding bits that are not zero");
    const auto high = bytes.subspan(in.offset());
    if (high.empty() || high.back() == std::byte{0}) in.fail("the row does not end with an id");

    std::uint64_t i = 0;
    for (std::size_t at = 0; at < high.size(); at += 8) {
      std::uint64_t word = word_at(high, at);
      for (; word != 0; word &= word - 1, ++i) {
        if (i == count) in.fail("more ids than the row states");
        const std::uint64_t low =
            low_bits == 0
                ? 0
                : lowest_bits(word_at(bytes, low_begin + i * low_bits / 8) >> (i * low_bits % 8), low_bits);
        const std::uint64_t id =
            (at * 8 + static_cast<unsigned>(std::countr_zero(word)) - i) << low_bits | low;
        if (id >= columns) in.fail("an id beyond the row's columns");
        sink.id(static_cast<std::uint32_t>(id));
      }
    }
    if (i != count) in.fail("fewer ids than the row states");
  }
};

}  // namespace vismat
