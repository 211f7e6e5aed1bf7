// The row codec `quake-rle`: Quake's run lengths of zero bytes, row by row (Quake, Quake 2, Source).
#pragma once
#include <cstddef>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include "codecs/rows/row_codec.h"

namespace vismat {

/// Each byte of the row's bitmap as it is, but a run of 1 to 255 zero bytes as 0 and the run's length; runs end with
/// their row. There is no escape, as the engines have none: a row may take 3/2 of its bitmap and a byte.
struct QuakeRows {
  static constexpr bool escapes = false;
  std::uint32_t columns;
  static QuakeRows fit(const VisibilityMatrix& matrix) { return {matrix.shape().columns}; }
  void write_model(std::vector<std::byte>&) const {}
  static QuakeRows read_model(ByteReader&, Shape shape) { return {shape.columns}; }
  void encode(std::span<const std::uint32_t> ids, std::vector<std::byte>& out) const;

  template <typename Sink>
  void decode(std::span<const std::byte> bytes, Sink& sink) const {
    const std::size_t row_bytes = row_bytes_of(columns);
    std::size_t place = 0;  // in the bitmap's row
    for (std::size_t at = 0; at < bytes.size(); ++at) {
      auto byte = std::to_integer<unsigned>(bytes[at]);
      if (place >= row_bytes) throw FormatError("bytes after the row's end");
      if (byte == 0) {
        const std::size_t run = ++at < bytes.size() ? std::to_integer<std::size_t>(bytes[at]) : 0;
        if (run == 0 || run > row_bytes - place) {
          throw FormatError("a run of " + std::to_string(run) + " zero bytes; " +
                            std::to_string(row_bytes - place) + " are left in the row");
        }
        place += run;
        continue;
      }
      for (; byte != 0; byte &= byte - 1)
        sink.id(static_cast<std::uint32_t>(place * 8) + static_cast<std::uint32_t>(std::countr_zero(byte)));
      ++place;
    }
    if (place != row_bytes) {
      throw FormatError(std::to_string(place) + " bytes of a bitmap row; " + std::to_string(columns) +
                        " columns need " + std::to_string(row_bytes));
    }
  }
};

}  // namespace vismat
