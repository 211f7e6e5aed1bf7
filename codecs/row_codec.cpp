#include "codecs/row_codec.h"

#include <algorithm>

namespace vismat {

RowIndex::RowIndex(std::span<const std::byte> index, std::uint32_t rows, std::uint32_t rows_per_part,
                   std::uint64_t payload_bytes)
    : parts_((std::uint64_t{rows} + rows_per_part - 1) / rows_per_part),
      payload_bytes_(payload_bytes),
      rows_per_part_(rows_per_part) {
  if (!index.empty()) {
    places_ = EliasFano(index, parts_ + 1, payload_bytes);
  } else if (parts_ == 0 ? payload_bytes != 0 : payload_bytes % parts_ != 0) {
    throw FormatError("no row index, and " + std::to_string(payload_bytes) + " bytes are not " +
                      std::to_string(parts_) + " equal parts");
  } else {
    equal_bytes_ = parts_ == 0 ? 0 : payload_bytes / parts_;
  }
}

std::vector<std::byte> row_index_bytes(std::span<const std::uint64_t> starts) {
  const bool equal = starts.front() == 0 &&
                     std::adjacent_find(starts.begin(), starts.end(), [&](std::uint64_t a, std::uint64_t b) {
                       return b - a != starts[1];
                     }) == starts.end();
  return equal ? std::vector<std::byte>{} : elias_fano_bytes(starts, starts.back());
}

VisibilityMatrix decode_rows(decltype(Codec::open_rows) open_rows, std::uint32_t rows_per_part,
                             std::span<const std::byte> payload, std::span<const std::byte> index,
                             Shape shape, std::uint64_t most) {
  constexpr auto anywhere = [](std::uint64_t, std::uint64_t) {};
  const RowIndex places(index, shape.rows, rows_per_part, payload.size());
  std::uint64_t end = places.parts() == 0 ? payload.size() : places.model_bytes(anywhere);
  const auto decoder = open_rows(payload.first(end), shape);
  std::vector<std::uint64_t> offsets = {0};
  offsets.reserve(std::size_t{shape.rows} + 1);
  std::vector<std::uint32_t> ids;
  RowBuffer<std::uint32_t> row;
  std::span<const std::byte> part;
  for (std::uint32_t r = 0; r < shape.rows; ++r) {
    try {
      if (r % rows_per_part == 0) {
        const auto place = places.part(r / rows_per_part, anywhere);
        if (place.begin != end) throw FormatError("the row index is damaged");
        part = payload.subspan(place.begin, place.end - place.begin);
        end = place.end;
      }
      IdSink sink(row, shape.columns, most - ids.size());
      decoder->decode(r, part, sink);
      sink.finish();
    } catch (const FormatError& error) {
      throw FormatError("row " + std::to_string(r) + ": " + error.what());
    }
    ids.insert(ids.end(), row.content().begin(), row.content().end());
    offsets.push_back(ids.size());
  }
  if (end != payload.size())
    throw FormatError(std::to_string(payload.size() - end) + " bytes after the last row");
  return VisibilityMatrix::from_csr(shape, std::move(offsets), std::move(ids));
}

void put_bitmap_row(std::vector<std::byte>& out, std::span<const std::uint32_t> ids, std::uint32_t columns) {
  const std::size_t begin = out.size();
  out.resize(begin + row_bytes_of(columns), std::byte{0});
  for (const std::uint32_t c : ids) out[begin + c / 8] |= std::byte{1} << (c % 8);
}

}  // namespace vismat
