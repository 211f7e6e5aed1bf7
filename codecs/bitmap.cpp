#include "codecs/bitmap.h"

#include "matrix/claimed_shape.h"

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
  claimed_shape(shape.rows, 0, bytes.size());
  std::vector<std::uint64_t> offsets = {0};
  offsets.reserve(std::size_t{shape.rows} + 1);
  std::vector<std::uint32_t> ids;
  RowBuffer<std::uint32_t> row;
  const std::size_t row_bytes = row_bytes_of(shape.columns);
  for (std::uint32_t r = 0; r < shape.rows; ++r) {
    IdSink sink(row, shape.columns, shape.columns);
    get_bitmap_row(bytes.subspan(r * row_bytes, row_bytes), sink);
    sink.finish();
    ids.insert(ids.end(), row.content().begin(), row.content().end());
    offsets.push_back(ids.size());
  }
  return VisibilityMatrix::from_csr(shape, std::move(offsets), std::move(ids));
}

}  // namespace vismat
