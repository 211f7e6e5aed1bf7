#include "codecs/rows/row_codec.h"

namespace vismat {

VisibilityMatrix read_all_rows(const RowSource& rows, const Parts& parts, Shape shape, std::uint64_t most) {
  const auto read = [&](std::uint32_t row, RowScratch& scratch, IdSink& sink) {
    try {
      rows.read(row, scratch, sink);
    } catch (const FormatError& error) {
      throw FormatError("row " + std::to_string(row) + ": " + error.what());
    }
  };
  return matrix_of_rows(shape, parts.payload_bytes(), most, read);
}

void put_bitmap_row(std::vector<std::byte>& out, std::span<const std::uint32_t> ids, std::uint32_t columns) {
  const std::size_t begin = out.size();
  out.resize(begin + row_bytes_of(columns), std::byte{0});
  for (const std::uint32_t c : ids) out[begin + c / 8] |= std::byte{1} << (c % 8);
}

}  // namespace vismat
