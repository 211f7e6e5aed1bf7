// The visibility table as it stands: rows of bits, each row padded to a whole byte.
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "matrix/visibility_matrix.h"

namespace vismat {

/// ceil(columns / 8) bytes a row; bit c of a row is bit c % 8 of byte c / 8 (Quake's order). The "table size"
/// of paper 002 and what the general-purpose compressors get.
std::vector<std::byte> bitmap_bytes(const VisibilityMatrix& matrix);
inline std::uint64_t bitmap_size(Shape shape) {
  return std::uint64_t{shape.rows} * ((std::uint64_t{shape.columns} + 7) / 8);
}
/// Throws FormatError unless there are exactly bitmap_size(shape) bytes and the padding is zero.
VisibilityMatrix matrix_from_bitmap(std::span<const std::byte> bytes, Shape shape);

}  // namespace vismat
