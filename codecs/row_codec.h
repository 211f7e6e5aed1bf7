// Codecs that give any row alone. A payload is a model (what all rows share; often nothing) and behind it each row's
// bytes; the index tells where these begin.
//
// Such a codec is one type, Rows, and a line in a table: row_codec<Rows>("name", "contents"). It has
//
//   static Rows fit(const VisibilityMatrix&)                         the model for a matrix
//   void write_model(std::vector<std::byte>&) const
//   static Rows read_model(ByteReader&, Shape)                       FormatError on bytes that write_model cannot have made
//   void encode(std::span<const std::uint32_t> ids, std::vector<std::byte>& out)        appends one row
//   template <typename Sink> void decode(std::span<const std::byte>, Sink&) const       see row_sink.h; thread-safe
//   static constexpr bool escapes                                    a row that would take as much as its bitmap is the
//                                                                    bitmap: no row takes more
// or, where several rows share their bytes,
//   static constexpr std::uint32_t rows_per_part
//   void encode_part(const VisibilityMatrix&, std::uint32_t first, std::uint32_t end, std::vector<std::byte>& out)
//   template <typename Sink> void decode(std::span<const std::byte>, std::uint32_t row_in_part, Sink&) const
#pragma once
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "codecs/bit_stream.h"
#include "codecs/codec.h"
#include "codecs/elias_fano.h"
#include "codecs/row_sink.h"

namespace vismat {

/// Decodes single rows of one payload; holds its model and nothing else, so any number of threads may use it at a time.
class RowDecoder {
 public:
  virtual ~RowDecoder() = default;
  /// Row `row` out of its part's bytes. Throws FormatError on bytes that no encoder made.
  virtual void decode(std::uint32_t row, std::span<const std::byte> part, IdSink&) const = 0;
  virtual void decode(std::uint32_t row, std::span<const std::byte> part, RunSink&) const = 0;
  virtual void decode(std::uint32_t row, std::span<const std::byte> part, BitSink&) const = 0;
};

/// Where a payload's parts lie. Borrows the index.
class RowIndex {
 public:
  RowIndex() = default;
  /// An empty index: parts of equal length and no model. FormatError where the sizes do not fit.
  RowIndex(std::span<const std::byte> index, std::uint32_t rows, std::uint32_t rows_per_part,
           std::uint64_t payload_bytes);
  std::uint64_t parts() const { return parts_; }
  std::uint32_t rows_per_part() const { return rows_per_part_; }
  struct Place {
    std::uint64_t begin, end;
  };
  /// touch(offset, size): told of the index's bytes before they are read. FormatError unless the place lies in the payload.
  template <typename Touch>
  Place part(std::uint64_t part, const Touch& touch) const {
    if (equal_bytes_) return {part * *equal_bytes_, (part + 1) * *equal_bytes_};
    const auto [begin, end] = places_.pair(part, touch);
    if (begin > end || end > payload_bytes_) [[unlikely]]
      throw FormatError("the row index is damaged");
    return {begin, end};
  }
  template <typename Touch>
  std::uint64_t model_bytes(const Touch& touch) const {
    return equal_bytes_ ? 0 : part(0, touch).begin;
  }

 private:
  std::uint64_t parts_ = 0, payload_bytes_ = 0;
  std::uint32_t rows_per_part_ = 1;
  std::optional<std::uint64_t> equal_bytes_;
  EliasFano places_;
};

/// The index for parts that begin at `starts`, with the payload's size behind them.
std::vector<std::byte> row_index_bytes(std::span<const std::uint64_t> starts);

/// All rows of a codec that has open_rows; FormatError at more than `most` ones, before memory is taken for them.
VisibilityMatrix decode_rows(decltype(Codec::open_rows) open_rows, std::uint32_t rows_per_part,
                             std::span<const std::byte> payload, std::span<const std::byte> index,
                             Shape shape, std::uint64_t most = ~std::uint64_t{0});

inline std::size_t row_bytes_of(std::uint32_t columns) {
  return (std::size_t{columns} + 7) / 8;
}
/// Appends the row's bits, padded to a byte.
void put_bitmap_row(std::vector<std::byte>& out, std::span<const std::uint32_t> ids, std::uint32_t columns);
/// The row behind exactly row_bytes_of(columns) bytes; FormatError where padding is set.
template <typename Sink>
void get_bitmap_row(std::span<const std::byte> bytes, Sink& sink) {
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
class RowDecoderFor final : public RowDecoder {
 public:
  explicit RowDecoderFor(Rows rows) : rows_(std::move(rows)) {}
  void decode(std::uint32_t row, std::span<const std::byte> part, IdSink& sink) const override {
    decode_into(row, part, sink);
  }
  void decode(std::uint32_t row, std::span<const std::byte> part, RunSink& sink) const override {
    decode_into(row, part, sink);
  }
  void decode(std::uint32_t row, std::span<const std::byte> part, BitSink& sink) const override {
    decode_into(row, part, sink);
  }

 private:
  template <typename Sink>
  void decode_into([[maybe_unused]] std::uint32_t row, std::span<const std::byte> part, Sink& sink) const {
    if constexpr (requires { Rows::rows_per_part; }) {
      rows_.decode(part, row % Rows::rows_per_part, sink);
    } else {
      if constexpr (Rows::escapes) {
        const std::size_t bitmap = row_bytes_of(sink.columns());
        if (part.size() == bitmap) return get_bitmap_row(part, sink);
        if (part.size() > bitmap) [[unlikely]]
          throw FormatError("a row of " + std::to_string(part.size()) + " bytes; its bitmap has " +
                            std::to_string(bitmap));
      }
      rows_.decode(part, sink);
    }
  }
  Rows rows_;
};

template <typename Rows>
Encoded encode_rows_with(Rows rows, const VisibilityMatrix& matrix) {
  Encoded out;
  rows.write_model(out.payload);
  const auto [count, columns] = matrix.shape();
  std::vector<std::uint64_t> starts;
  if constexpr (requires { Rows::rows_per_part; }) {
    for (std::uint64_t first = 0; first < count; first += Rows::rows_per_part) {
      starts.push_back(out.payload.size());
      rows.encode_part(
          matrix, static_cast<std::uint32_t>(first),
          static_cast<std::uint32_t>(std::min<std::uint64_t>(count, first + Rows::rows_per_part)),
          out.payload);
    }
  } else {
    starts.reserve(std::size_t{count} + 1);
    for (std::uint32_t r = 0; r < count; ++r) {
      const std::size_t begin = out.payload.size();
      starts.push_back(begin);
      rows.encode(matrix.row(r), out.payload);
      if constexpr (Rows::escapes) {
        if (out.payload.size() - begin < row_bytes_of(columns)) continue;
        out.payload.resize(begin);
        put_bitmap_row(out.payload, matrix.row(r), columns);
      }
    }
  }
  starts.push_back(out.payload.size());
  out.index = row_index_bytes(starts);
  return out;
}

template <typename Rows>
Encoded encode_rows(const VisibilityMatrix& matrix, const ObjectTree*) {
  return encode_rows_with(Rows::fit(matrix), matrix);
}

template <typename Rows>
std::unique_ptr<const RowDecoder> open_rows(std::span<const std::byte> model, Shape shape) {
  ByteReader in(model, "model");
  Rows rows = Rows::read_model(in, shape);
  if (in.left() != 0) in.fail(std::to_string(in.left()) + " bytes after the model");
  return std::make_unique<RowDecoderFor<Rows>>(std::move(rows));
}

template <typename Rows>
constexpr std::uint32_t rows_per_part() {
  if constexpr (requires { Rows::rows_per_part; })
    return Rows::rows_per_part;
  else
    return 1;
}

template <typename Rows>
VisibilityMatrix decode_all_rows(std::span<const std::byte> payload, std::span<const std::byte> index,
                                 Shape shape, const ObjectTree*) {
  return decode_rows(open_rows<Rows>, rows_per_part<Rows>(), payload, index, shape);
}

}  // namespace detail

template <typename Rows>
constexpr Codec row_codec(std::string_view name, std::string_view contents) {
  Codec codec{};
  codec.name = name;
  codec.contents = contents;
  codec.encode = detail::encode_rows<Rows>;
  codec.decode = detail::decode_all_rows<Rows>;
  codec.open_rows = detail::open_rows<Rows>;
  codec.rows_per_part = detail::rows_per_part<Rows>();
  return codec;
}

}  // namespace vismat
