// The codecs `gzip-rows` and `unreal-chunks`: rows, or chunks of rows, through zlib.
//
// unreal-chunks is what Unreal does with precomputed visibility. The bits of the view cells lie in chunks, a chunk is a
// zlib stream, and a viewer who enters a view cell inflates the whole chunk, of which the cell's bits are a slice.
// Unreal keeps the last chunk inflated while the viewer stays in it; here every row that is read alone pays for its
// chunk, as a teleport would. How many view cells share a chunk is not published (a cell's place in it has 16 bits, so
// at most 64 KiB); the 64 rows are our choice.
#include <zlib.h>

#include <algorithm>
#include <memory>
#include <new>
#include <stdexcept>
#include <string>

#include "codecs/baselines/baseline_parts.h"
#include "codecs/rows/row_codec.h"

namespace vismat {
namespace {

using Bytes = std::span<const std::byte>;

enum Framing : int { raw = -15, zlib = 15 };  // zlib's window bits

// Reset for each stream: what a client would do.
class Deflater {
 public:
  explicit Deflater(Framing framing) {
    if (deflateInit2(&stream_, 9, Z_DEFLATED, framing, 8, Z_DEFAULT_STRATEGY) != Z_OK) throw std::bad_alloc();
  }
  ~Deflater() { deflateEnd(&stream_); }
  Deflater(const Deflater&) = delete;
  Deflater& operator=(const Deflater&) = delete;

  void append(Bytes in, std::vector<std::byte>& out) {
    if (in.size() >> 32 != 0) throw std::length_error("zlib takes less than 2^32 bytes at a time");
    deflateReset(&stream_);
    const std::size_t begin = out.size();
    out.resize(begin + deflateBound(&stream_, in.size()));
    stream_.next_in = reinterpret_cast<Bytef*>(const_cast<std::byte*>(in.data()));
    stream_.avail_in = static_cast<uInt>(in.size());
    stream_.next_out = reinterpret_cast<Bytef*>(out.data() + begin);
    stream_.avail_out = static_cast<uInt>(out.size() - begin);
    if (deflate(&stream_, Z_FINISH) != Z_STREAM_END) throw std::runtime_error("zlib: deflate failed");
    out.resize(out.size() - stream_.avail_out);
  }

 private:
  z_stream stream_{};
};

// A reader's scratch.
class Inflater {
 public:
  Inflater() {
    if (inflateInit2(&stream_, raw) != Z_OK) throw std::bad_alloc();
  }
  ~Inflater() { inflateEnd(&stream_); }
  Inflater(const Inflater&) = delete;
  Inflater& operator=(const Inflater&) = delete;

  // All that one stream contains, at most `most` bytes; valid until the next call. The buffer grows to the largest, but to no
  // more than 1032 bytes for one of the stream: deflate takes at least two bits for 258 equal bytes.
  Bytes inflate(Bytes in, std::size_t most, Framing framing) {
    if (most >> 32 != 0 || in.size() >> 32 != 0) throw FormatError("zlib: rows of 2^32 bytes or more");
    const std::size_t room = std::min(most, 1032 * in.size());
    if (room > capacity_ || buffer_ == nullptr) {
      buffer_ = std::make_unique_for_overwrite<std::byte[]>(room + 1);
      capacity_ = room;
    }
    inflateReset2(&stream_, framing);
    stream_.next_in = reinterpret_cast<Bytef*>(const_cast<std::byte*>(in.data()));
    stream_.avail_in = static_cast<uInt>(in.size());
    stream_.next_out = reinterpret_cast<Bytef*>(buffer_.get());
    stream_.avail_out = static_cast<uInt>(room);
    if (::inflate(&stream_, Z_FINISH) != Z_STREAM_END || stream_.avail_in != 0)
      throw FormatError("zlib: damaged, cut short, or more than " + std::to_string(most) + " bytes");
    return {buffer_.get(), room - stream_.avail_out};
  }

 private:
  z_stream stream_{};
  std::unique_ptr<std::byte[]> buffer_;
  std::size_t capacity_ = 0;
};

class GzipRows {
 public:
  static constexpr bool escapes = false;
  static GzipRows fit(const VisibilityMatrix& matrix) {
    GzipRows rows(matrix.shape().columns);
    rows.deflater_ = std::make_unique<Deflater>(raw);
    return rows;
  }
  void write_model(std::vector<std::byte>&) const {}
  static GzipRows read_model(ByteReader&, Shape shape) { return GzipRows(shape.columns); }
  void encode(std::span<const std::uint32_t> ids, std::vector<std::byte>& out) {
    row_.clear();
    put_bitmap_row(row_, ids, columns_);
    deflater_->append(row_, out);
  }
  template <typename Sink>
  void decode(Bytes bytes, std::uint32_t, RowScratch& scratch, Sink& sink) const {
    const std::size_t size = row_bytes_of(columns_);
    const Bytes row = scratch.as<Inflater>().inflate(bytes, size, raw);
    if (row.size() != size)
      throw FormatError("inflates to " + std::to_string(row.size()) + " bytes; a row has " +
                        std::to_string(size));
    get_bitmap_row(row, sink);
  }

 private:
  explicit GzipRows(std::uint32_t columns) : columns_(columns) {}
  std::uint32_t columns_;
  std::vector<std::byte> row_;
  std::unique_ptr<Deflater> deflater_;  // an encoder's
};

class UnrealChunks {
 public:
  static constexpr std::uint32_t rows_per_part = 64;
  static UnrealChunks fit(const VisibilityMatrix& matrix) {
    UnrealChunks rows(matrix.shape());
    rows.deflater_ = std::make_unique<Deflater>(zlib);
    return rows;
  }
  void write_model(std::vector<std::byte>&) const {}
  static UnrealChunks read_model(ByteReader&, Shape shape) { return UnrealChunks(shape); }
  void encode_part(const VisibilityMatrix& matrix, std::uint32_t first, std::uint32_t end,
                   std::vector<std::byte>& out) const {
    std::vector<std::byte> chunk;
    for (std::uint32_t r = first; r < end; ++r) put_bitmap_row(chunk, matrix.row(r), shape_.columns);
    deflater_->append(chunk, out);
  }
  template <typename Sink>
  void decode(Bytes bytes, std::uint32_t row_in_part, RowScratch& scratch, Sink& sink) const {
    const std::size_t size = row_bytes_of(shape_.columns), full = rows_per_part * size,
                      last = shape_.rows % rows_per_part * size;
    const Bytes chunk = scratch.as<Inflater>().inflate(bytes, full, zlib);
    if ((chunk.size() != full && chunk.size() != last) || (row_in_part + 1) * size > chunk.size())
      throw FormatError("a chunk inflates to " + std::to_string(chunk.size()) +
                        " bytes, which are not its rows of " + std::to_string(size));
    get_bitmap_row(chunk.subspan(row_in_part * size, size), sink);
  }

 private:
  explicit UnrealChunks(Shape shape) : shape_(shape) {}
  Shape shape_;
  std::unique_ptr<Deflater> deflater_;  // an encoder's
};

}  // namespace

std::array<Codec, 2> zlib_row_baselines() {
  return {row_codec<GzipRows>("gzip-rows", "each row's bitmap through deflate -9", Origin::baseline),
          row_codec<UnrealChunks>("unreal-chunks", "64 rows' bitmaps through zlib -9, inflated for each row",
                                  Origin::baseline)};
}

}  // namespace vismat
