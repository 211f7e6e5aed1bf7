#include "codecs/row_codec.h"

#include <algorithm>

#include "matrix/claimed_shape.h"

namespace vismat {

// What is asked for at once is backed by the payload's bytes; the rest as rows come.
VisibilityMatrix read_all_rows(const RowSource& rows, const Parts& parts, Shape shape, std::uint64_t most) {
  if (parts.payload_bytes() == 0) claimed_shape(shape.rows, 0, 0);
  std::vector<std::uint64_t> offsets = {0};
  offsets.reserve(std::min<std::size_t>(shape.rows, (1 << 22) + 8 * parts.payload_bytes()) + 1);
  std::vector<std::uint32_t> ids;
  RowBuffer<std::uint32_t> row;
  for (std::uint32_t r = 0; r < shape.rows; ++r) {
    try {
      IdSink sink(row, shape.columns, most - ids.size());
      rows.read(r, row, sink);
      sink.finish();
    } catch (const FormatError& error) {
      throw FormatError("row " + std::to_string(r) + ": " + error.what());
    }
    ids.insert(ids.end(), row.content().begin(), row.content().end());
    offsets.push_back(ids.size());
  }
  return VisibilityMatrix::from_csr(shape, std::move(offsets), std::move(ids));
}

void put_bitmap_row(std::vector<std::byte>& out, std::span<const std::uint32_t> ids, std::uint32_t columns) {
  const std::size_t begin = out.size();
  out.resize(begin + row_bytes_of(columns), std::byte{0});
  for (const std::uint32_t c : ids) out[begin + c / 8] |= std::byte{1} << (c % 8);
}

}  // namespace vismat
