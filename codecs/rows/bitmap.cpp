#include "codecs/rows/bitmap.h"

namespace vismat {

std::vector<std::byte> bitmap_bytes(const VisibilityMatrix& matrix) {
  std::vector<std::byte> bytes;
  bytes.reserve(bitmap_size(matrix.shape()));
  for (std::uint32_t r = 0; r < matrix.shape().rows; ++r)
    put_bitmap_row(bytes, matrix.row(r), matrix.shape().columns);
  return bytes;
}

VisibilityMatrix matrix_from_bitmap(std::span<const std::byte> bytes, Shape shape) {
  if (bytes.size() != bitmap_size(shape)) {
    throw FormatError("bitmap of " + std::to_string(bytes.size()) + " bytes; " + std::to_string(shape.rows) +
                      " x " + std::to_string(shape.columns) + " needs " + std::to_string(bitmap_size(shape)));
  }
  const std::size_t row_bytes = row_bytes_of(shape.columns);
  const auto read = [&](std::uint32_t row, RowScratch&, IdSink& sink) {
    get_bitmap_row(bytes.subspan(row * row_bytes, row_bytes), sink);
  };
  return matrix_of_rows(shape, bytes.size(), ~std::uint64_t{0}, read);
}

}  // namespace vismat
