#include "codecs/bitmap.h"

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
  return detail::decode_all_rows<BitmapRows>(bytes, {}, shape, nullptr);
}

}  // namespace vismat
