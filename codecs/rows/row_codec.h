// Row codecs: codecs that decode any row alone. A payload is a model (what all rows share; often nothing) and behind it
// the parts, one for each row or group of rows; the index says where these begin (part_index.h).
//
// Such a codec is one type, Rows, and a line in a table: row_codec<Rows>("name", "contents"). Rows has one of the forms
// of each of the following:
//
//   static Rows fit(const VisibilityMatrix&)                         the model for a matrix
//   static Rows fit(const VisibilityMatrix&, const Side&, const EncodeOptions&)
//   void write_model(std::vector<std::byte>&) const
//   static Rows read_model(ByteReader&, Shape)                       FormatError on bytes that write_model cannot have made
//   static Rows read_model(ByteReader&, Shape, const Side&)
//
//   encoding, one row in each part
//   void encode(std::span<const std::uint32_t> ids, std::vector<std::byte>& out)        appends one row
//   static constexpr bool escapes                                    a row that would take as many bytes as its bitmap is
//                                                                    stored as its bitmap; no row takes more
//   encoding, rows_per_part rows in each part
//   static constexpr std::uint32_t rows_per_part
//   void encode_part(const VisibilityMatrix&, std::uint32_t first, std::uint32_t end, std::vector<std::byte>& out)
//   void write_shared(Encoded&) const                                optional: shared sections and bands
//
//   static constexpr bool writes_all_words                           optional: whether a BitSink's words need not be zero before
//   static constexpr IndexForm index_form                            optional: how the parts are found (part_index.h)
//
//   decoding from the row's part alone; thread-safe; Sink: row_sink.h
//   template <typename Sink> void decode(std::span<const std::byte>, Sink&) const
//   template <typename Sink> void decode(std::span<const std::byte>, std::uint32_t row_in_part, RowScratch&, Sink&) const
//   decoding a row that depends on others, from any parts and shared sections
//   template <typename Sink> void decode_row(std::uint32_t row, const Parts&, RowScratch&, Sink&) const
//   RowSource::Cost cost(std::uint32_t row, const Parts&) const      what that reads
#pragma once
#include <algorithm>
#include <cstring>
#include <memory>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "codecs/codec.h"
#include "codecs/entropy/bit_stream.h"
#include "codecs/vmat/part_index.h"
#include "codecs/vmat/parts.h"
#include "codecs/vmat/row_sink.h"
#include "codecs/vmat/row_source.h"

namespace vismat {

constexpr std::size_t row_bytes_of(std::uint32_t columns) {
  return (std::size_t{columns} + 7) / 8;
}
/// Appends the row's bits, padded to a byte.
void put_bitmap_row(std::vector<std::byte>& out, std::span<const std::uint32_t> ids, std::uint32_t columns);
/// Gives the sink the row of exactly row_bytes_of(columns) bytes. Throws FormatError if padding is set.
template <typename Sink>
void get_bitmap_row(std::span<const std::byte> bytes, Sink& sink) {
  if constexpr (std::is_same_v<Sink, BitSink>) {
    return sink.words([&](std::span<std::uint64_t> words) {
      if (words.empty()) return;
      words.back() = 0;
      std::memcpy(words.data(), bytes.data(), bytes.size());
      if (sink.columns() % 64 != 0 && words.back() >> (sink.columns() % 64) != 0)
        throw FormatError("a bitmap with ones behind its last column");
    });
  }
  std::uint64_t gap = 0;  // zeros since the last one
  for (std::size_t at = 0; at < bytes.size(); at += 8) {
    std::uint64_t word = word_at(bytes, at);
    unsigned left = 64;  // of the word; what was taken is shifted out
    while (word != 0) {
      const auto zeros = static_cast<unsigned>(std::countr_zero(word));
      const auto ones = static_cast<unsigned>(std::countr_one(word >> zeros));
      sink.run(gap + zeros, ones);
      gap = 0;
      left -= zeros + ones;
      word = left == 0 ? 0 : word >> zeros >> ones;
    }
    gap += left;
  }
}

namespace detail {

template <typename Rows>
constexpr bool escapes() {
  if constexpr (requires { Rows::escapes; })
    return Rows::escapes;
  else
    return false;
}

template <typename Rows>
constexpr std::uint32_t rows_per_part() {
  if constexpr (requires { Rows::rows_per_part; })
    return Rows::rows_per_part;
  else
    return 1;
}

template <typename Rows>
constexpr IndexForm index_form() {
  if constexpr (requires { Rows::index_form; })
    return Rows::index_form;
  else
    return IndexForm::small;
}

template <typename Rows>
class RowsOf final : public RowSource {
 public:
  RowsOf(Rows rows, Parts parts) : rows_(std::move(rows)), parts_(std::move(parts)) {}
  void read(std::uint32_t row, RowScratch& scratch, IdSink& sink) const override {
    decode(row, scratch, sink);
  }
  void read(std::uint32_t row, RowScratch& scratch, RunSink& sink) const override {
    decode(row, scratch, sink);
  }
  void read(std::uint32_t row, RowScratch& scratch, BitSink& sink) const override {
    decode(row, scratch, sink);
  }
  bool writes_all_words() const override {
    if constexpr (requires { Rows::writes_all_words; })
      return Rows::writes_all_words;
    else
      return false;
  }
  Cost cost(std::uint32_t row) const override {
    if constexpr (requires { rows_.cost(row, parts_); })
      return rows_.cost(row, parts_);
    else
      return {parts_.part_bytes(row / rows_per_part<Rows>()), 1};
  }

 private:
  template <typename Sink>
  void decode(std::uint32_t row, [[maybe_unused]] RowScratch& scratch, Sink& sink) const {
    if constexpr (requires { rows_.decode_row(row, parts_, scratch, sink); }) {
      rows_.decode_row(row, parts_, scratch, sink);
    } else {
      const std::span<const std::byte> part = parts_.part(row / rows_per_part<Rows>());
      if constexpr (escapes<Rows>()) {
        const std::size_t bitmap = row_bytes_of(sink.columns());
        if (part.size() == bitmap) return get_bitmap_row(part, sink);
        if (part.size() > bitmap) [[unlikely]]
          throw FormatError("a row of " + std::to_string(part.size()) + " bytes; its bitmap has " +
                            std::to_string(bitmap));
      }
      if constexpr (requires { rows_.decode(part, row, scratch, sink); })
        rows_.decode(part, row % rows_per_part<Rows>(), scratch, sink);
      else
        rows_.decode(part, sink);
    }
  }
  Rows rows_;
  Parts parts_;
};

template <typename Rows>
Encoded encode_rows_with(Rows rows, const VisibilityMatrix& matrix) {
  Encoded out;
  rows.write_model(out.payload);
  const auto [count, columns] = matrix.shape();
  std::vector<std::uint64_t> starts;
  if constexpr (requires { &Rows::encode_part; }) {
    constexpr std::uint32_t step = rows_per_part<Rows>();
    for (std::uint64_t first = 0; first < count; first += step) {
      starts.push_back(out.payload.size());
      rows.encode_part(matrix, static_cast<std::uint32_t>(first),
                       static_cast<std::uint32_t>(std::min<std::uint64_t>(count, first + step)), out.payload);
    }
  } else {
    starts.reserve(count);
    for (std::uint32_t r = 0; r < count; ++r) {
      const std::size_t begin = out.payload.size();
      starts.push_back(begin);
      rows.encode(matrix.row(r), out.payload);
      if constexpr (escapes<Rows>()) {
        if (out.payload.size() - begin < row_bytes_of(columns)) continue;
        out.payload.resize(begin);
        put_bitmap_row(out.payload, matrix.row(r), columns);
      }
    }
  }
  if constexpr (requires { rows.write_shared(out); }) rows.write_shared(out);
  out.index = part_index_bytes(starts, out.payload.size(), index_form<Rows>());
  return out;
}

template <typename Rows>
Encoded encode_rows(const VisibilityMatrix& matrix, [[maybe_unused]] const Side& side,
                    [[maybe_unused]] const EncodeOptions& options) {
  if constexpr (requires { Rows::fit(matrix, side, options); })
    return encode_rows_with(Rows::fit(matrix, side, options), matrix);
  else
    return encode_rows_with(Rows::fit(matrix), matrix);
}

template <typename Rows>
std::unique_ptr<const RowSource> open_rows(Parts parts, Shape shape, [[maybe_unused]] const Side& side) {
  parts.expect((std::uint64_t{shape.rows} + rows_per_part<Rows>() - 1) / rows_per_part<Rows>());
  if constexpr (!requires(const Rows& rows, Encoded& out) { rows.write_shared(out); })
    parts.expect_no_sections();
  ByteReader in(parts.model(), "model");
  const auto read = [&] {
    if constexpr (requires { Rows::read_model(in, shape, side); })
      return Rows::read_model(in, shape, side);
    else
      return Rows::read_model(in, shape);
  };
  Rows rows = read();
  if (in.left() != 0) in.fail(std::to_string(in.left()) + " bytes after the model");
  return std::make_unique<RowsOf<Rows>>(std::move(rows), std::move(parts));
}

template <typename Rows>
VisibilityMatrix decode_rows(const Parts& parts, Shape shape, const Side& side, std::uint64_t most) {
  return read_all_rows(*open_rows<Rows>(parts, shape, side), parts, shape, most);
}

}  // namespace detail

template <typename Rows>
constexpr Codec row_codec(std::string_view name, std::string_view contents, Origin origin) {
  Codec codec{.name = name, .contents = contents, .origin = origin};
  codec.encode = detail::encode_rows<Rows>;
  codec.decode = detail::decode_rows<Rows>;
  codec.open = detail::open_rows<Rows>;
  codec.rows_per_part = detail::rows_per_part<Rows>();
  return codec;
}

}  // namespace vismat
