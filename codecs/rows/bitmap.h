// The visibility matrix as it is: rows of bits, each row padded to a whole byte.
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "codecs/rows/row_codec.h"
#include "matrix/visibility_matrix.h"

namespace vismat {

/// ceil(columns / 8) bytes for each row; bit c of a row is bit c % 8 of byte c / 8 (Quake's order). This is the "table
/// size" of Zach and Karner 2003 and the input of the general-purpose compressors.
std::vector<std::byte> bitmap_bytes(const VisibilityMatrix& matrix);
inline std::uint64_t bitmap_size(Shape shape) {
  return std::uint64_t{shape.rows} * row_bytes_of(shape.columns);
}
/// Throws FormatError unless there are exactly bitmap_size(shape) bytes and the padding is zero.
VisibilityMatrix matrix_from_bitmap(std::span<const std::byte> bytes, Shape shape);

struct BitmapRows {
  static constexpr bool escapes = true;  // every row is its bitmap
  static constexpr bool writes_all_words = true;
  std::uint32_t columns;
  static BitmapRows fit(const VisibilityMatrix& matrix) { return {matrix.shape().columns}; }
  void write_model(std::vector<std::byte>&) const {}
  static BitmapRows read_model(ByteReader&, Shape shape) { return {shape.columns}; }
  void encode(std::span<const std::uint32_t> ids, std::vector<std::byte>& out) const {
    put_bitmap_row(out, ids, columns);
  }
  template <typename Sink>
  void decode(std::span<const std::byte> bytes, Sink& sink) const {  // if the size differs from a bitmap's
    throw FormatError("bitmap row of " + std::to_string(bytes.size()) + " bytes; " +
                      std::to_string(sink.columns()) + " columns need " +
                      std::to_string(row_bytes_of(sink.columns())));
  }
};

}  // namespace vismat
