#include "codecs/quake_rle.h"

#include <string>
#include <utility>

#include "codecs/bitmap.h"
#include "matrix/byte_reader.h"

namespace vismat {

std::vector<std::byte> quake_rle_bytes(const VisibilityMatrix& matrix) {
  const std::vector<std::byte> bitmap = bitmap_bytes(matrix);
  const std::size_t row_bytes = (std::size_t{matrix.shape().columns} + 7) / 8;
  std::vector<std::byte> out;
  for (std::size_t row = 0; row < bitmap.size(); row += row_bytes) {
    for (std::size_t i = row; i < row + row_bytes;) {
      out.push_back(bitmap[i]);
      if (bitmap[i++] != std::byte{0}) continue;
      unsigned run = 1;
      for (; i < row + row_bytes && bitmap[i] == std::byte{0} && run < 255; ++i) ++run;
      out.push_back(static_cast<std::byte>(run));
    }
  }
  return out;
}

VisibilityMatrix matrix_from_quake_rle(std::span<const std::byte> bytes, Shape shape) {
  ByteReader in(bytes, "quake-rle");
  const std::size_t row_bytes = (std::size_t{shape.columns} + 7) / 8;
  if (row_bytes > 0 && shape.rows / 255 > bytes.size())
    in.fail("too few bytes for " + std::to_string(shape.rows) + " rows");
  std::vector<std::uint64_t> offsets = {0};
  std::vector<std::uint32_t> ids;
  for (std::uint32_t r = 0; r < shape.rows; ++r) {
    for (std::size_t b = 0; b < row_bytes;) {
      const auto byte = in.number<std::uint8_t>();
      if (byte == 0) {
        const auto run = in.number<std::uint8_t>();
        if (run == 0 || run > row_bytes - b) {
          in.fail("row " + std::to_string(r) + ": a run of " + std::to_string(run) + " zero bytes; " +
                  std::to_string(row_bytes - b) + " are left in the row");
        }
        b += run;
        continue;
      }
      for (unsigned bit = 0; bit < 8; ++bit) {
        if (byte >> bit & 1) ids.push_back(static_cast<std::uint32_t>(b * 8 + bit));
      }
      ++b;
    }
    if (ids.size() > offsets.back() && ids.back() >= shape.columns)
      in.fail("row " + std::to_string(r) + ": a padding bit is set");
    offsets.push_back(ids.size());
  }
  if (in.left() != 0) in.fail(std::to_string(in.left()) + " bytes after the last row");
  return VisibilityMatrix::from_csr(shape, std::move(offsets), std::move(ids));
}

}  // namespace vismat
