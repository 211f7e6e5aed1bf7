#include "codecs/bitmap.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <string>
#include <utility>

#include "matrix/byte_reader.h"

namespace vismat {

std::vector<std::byte> bitmap_bytes(const VisibilityMatrix& matrix) {
  const std::size_t row_bytes = (std::size_t{matrix.shape().columns} + 7) / 8;
  std::vector<std::byte> bytes(matrix.shape().rows * row_bytes, std::byte{0});
  for (std::uint32_t r = 0; r < matrix.shape().rows; ++r) {
    std::byte* row = bytes.data() + r * row_bytes;
    for (const std::uint32_t c : matrix.row(r)) row[c / 8] |= std::byte{1} << (c % 8);
  }
  return bytes;
}

VisibilityMatrix matrix_from_bitmap(std::span<const std::byte> bytes, Shape shape) {
  if (bytes.size() != bitmap_size(shape)) {
    throw FormatError("bitmap of " + std::to_string(bytes.size()) + " bytes; " + std::to_string(shape.rows) +
                      " x " + std::to_string(shape.columns) + " needs " + std::to_string(bitmap_size(shape)));
  }
  if (bytes.empty()) return VisibilityMatrix(shape);
  const std::size_t row_bytes = bytes.size() / shape.rows;
  std::vector<std::uint64_t> offsets = {0};
  offsets.reserve(std::size_t{shape.rows} + 1);
  std::vector<std::uint32_t> ids;
  for (std::uint32_t r = 0; r < shape.rows; ++r) {
    const auto row = bytes.subspan(r * row_bytes, row_bytes);
    for (std::size_t b = 0; b < row_bytes; b += 8) {
      std::uint64_t word = 0;
      std::memcpy(&word, row.data() + b, std::min<std::size_t>(8, row_bytes - b));
      for (; word != 0; word &= word - 1)
        ids.push_back(static_cast<std::uint32_t>(b * 8 + static_cast<std::size_t>(std::countr_zero(word))));
    }
    if (ids.size() > offsets.back() && ids.back() >= shape.columns) {
      throw FormatError("bitmap row " + std::to_string(r) + ": a padding bit is set");
    }
    offsets.push_back(ids.size());
  }
  return VisibilityMatrix::from_csr(shape, std::move(offsets), std::move(ids));
}

}  // namespace vismat
