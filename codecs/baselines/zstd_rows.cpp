// The codecs `zstd-rows` and `zstd-dict`: rows through zstd -19, without a dictionary, and with one that is trained on
// the rows and stored in front.
//
// A row is one frame without its optional parts: no magic number, size, checksum or dictionary number. Its head is then
// a zero byte and the window's size, and blocks follow. libzstd also reads several frames in a row, and formats older
// than zstd 1.0 by their magic numbers even if it is told that there are none. Both are refused here before libzstd
// sees them.
#define ZSTD_STATIC_LINKING_ONLY  // for the frames without magic number
#include <zdict.h>
#include <zstd.h>

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

std::size_t done(std::size_t result) {
  if (ZSTD_isError(result)) throw std::runtime_error(std::string("zstd: ") + ZSTD_getErrorName(result));
  return result;
}

struct FreeZstd {
  void operator()(ZSTD_CCtx* context) const { ZSTD_freeCCtx(context); }
  void operator()(ZSTD_DCtx* context) const { ZSTD_freeDCtx(context); }
  void operator()(ZSTD_CDict* dictionary) const { ZSTD_freeCDict(dictionary); }
  void operator()(ZSTD_DDict* dictionary) const { ZSTD_freeDDict(dictionary); }
};
template <typename T>
using Owned = std::unique_ptr<T, FreeZstd>;
template <typename T>
Owned<T> owned(T* made) {
  if (made == nullptr) throw std::bad_alloc();
  return Owned<T>(made);
}

Owned<ZSTD_CCtx> compressor() {
  auto made = owned(ZSTD_createCCtx());
  done(ZSTD_CCtx_setParameter(made.get(), ZSTD_c_compressionLevel, 19));
  done(ZSTD_CCtx_setParameter(made.get(), ZSTD_c_format, ZSTD_f_zstd1_magicless));
  done(ZSTD_CCtx_setParameter(made.get(), ZSTD_c_contentSizeFlag, 0));
  done(ZSTD_CCtx_setParameter(made.get(), ZSTD_c_dictIDFlag, 0));
  return made;
}

// One frame as described above, and nothing behind it.
void check_frame(Bytes bytes) {
  ByteReader in(bytes, "zstd row");
  if (in.number<std::uint8_t>() != 0) in.fail("a frame with a size, checksum or dictionary number");
  in.skip(1);
  for (bool last = false; !last;) {
    const auto low = in.number<std::uint16_t>();
    const std::uint32_t head = low | std::uint32_t{in.number<std::uint8_t>()}
                                         << 16;  // last, 2 bits of kind, size
    last = (head & 1) != 0;
    const bool repeated = (head >> 1 & 3) == 1;
    in.skip(repeated ? 1 : head >> 3);
  }
  if (in.left() != 0) in.fail(std::to_string(in.left()) + " bytes after the frame");
}

// A reader's scratch.
class Decompressor {
 public:
  Decompressor() : context_(owned(ZSTD_createDCtx())) {
    done(ZSTD_DCtx_setParameter(context_.get(), ZSTD_d_format, ZSTD_f_zstd1_magicless));
  }
  // At most `most` bytes; valid until the next call.
  Bytes decompress(Bytes frame, std::size_t most, const ZSTD_DDict* dictionary) {
    check_frame(frame);
    const std::size_t room =
        std::min(most, frame.size() / 3 << 17);  // a block takes 3 bytes or more, gives 2^17 or less
    if (room > capacity_ || buffer_ == nullptr) {
      buffer_ = std::make_unique_for_overwrite<std::byte[]>(room + 1);
      capacity_ = room;
    }
    const std::size_t size = ZSTD_decompress_usingDDict(context_.get(), buffer_.get(), room, frame.data(),
                                                        frame.size(), dictionary);
    if (ZSTD_isError(size)) throw FormatError(std::string("zstd row: ") + ZSTD_getErrorName(size));
    return {buffer_.get(), size};
  }

 private:
  Owned<ZSTD_DCtx> context_;
  std::unique_ptr<std::byte[]> buffer_;
  std::size_t capacity_ = 0;
};

// A thirtieth of the data, between the library's least size and the program's default. zdict.h recommends a hundredth; of
// six level matrices a thirtieth made four smaller, by 1 to 12 %, and two larger, by 6 %. Empty where training fails: few or
// tiny rows.
std::vector<std::byte> trained_dictionary(const VisibilityMatrix& matrix) {
  std::vector<std::byte> samples;
  std::vector<std::size_t> sizes;
  for (std::uint32_t r = 0; r < matrix.shape().rows; ++r) {
    put_bitmap_row(samples, matrix.row(r), matrix.shape().columns);
    sizes.push_back(row_bytes_of(matrix.shape().columns));
  }
  std::vector<std::byte> dictionary(std::clamp<std::size_t>(samples.size() / 30, 256, 112640));
  const std::size_t size = ZDICT_trainFromBuffer(dictionary.data(), dictionary.size(), samples.data(),
                                                 sizes.data(), static_cast<unsigned>(sizes.size()));
  dictionary.resize(ZDICT_isError(size) ? 0 : size);
  return dictionary;
}

template <bool with_dictionary>
class ZstdRows {
 public:
  static constexpr bool escapes = false;
  static ZstdRows fit(const VisibilityMatrix& matrix) {
    ZstdRows rows(matrix.shape().columns);
    rows.compressor_ = compressor();
    if constexpr (with_dictionary) {
      rows.dictionary_ = trained_dictionary(matrix);
      if (!rows.dictionary_.empty())
        rows.encoding_ = owned(ZSTD_createCDict(rows.dictionary_.data(), rows.dictionary_.size(), 19));
    }
    return rows;
  }
  void write_model(std::vector<std::byte>& out) const {
    out.insert(out.end(), dictionary_.begin(), dictionary_.end());
  }
  static ZstdRows read_model([[maybe_unused]] ByteReader& in, Shape shape) {
    ZstdRows rows(shape.columns);
    if (with_dictionary && in.left() > 0) {
      const Bytes dictionary = in.bytes(in.left());
      rows.decoding_ = Owned<ZSTD_DDict>(ZSTD_createDDict(dictionary.data(), dictionary.size()));
      if (rows.decoding_ == nullptr) throw FormatError("the zstd dictionary is damaged");
    }
    return rows;
  }
  void encode(std::span<const std::uint32_t> ids, std::vector<std::byte>& out) {
    row_.clear();
    put_bitmap_row(row_, ids, columns_);
    ZSTD_CCtx* const context = compressor_.get();
    done(ZSTD_CCtx_refCDict(context, encoding_.get()));
    const std::size_t begin = out.size();
    out.resize(begin + ZSTD_compressBound(row_.size()));
    out.resize(begin + done(ZSTD_compress2(context, out.data() + begin, out.size() - begin, row_.data(),
                                           row_.size())));
  }
  template <typename Sink>
  void decode(Bytes bytes, std::uint32_t, RowScratch& scratch, Sink& sink) const {
    const std::size_t size = row_bytes_of(columns_);
    const Bytes row = scratch.as<Decompressor>().decompress(bytes, size, decoding_.get());
    if (row.size() != size)
      throw FormatError("zstd row of " + std::to_string(row.size()) + " bytes, not " + std::to_string(size));
    get_bitmap_row(row, sink);
  }

 private:
  explicit ZstdRows(std::uint32_t columns) : columns_(columns) {}
  std::uint32_t columns_;
  std::vector<std::byte> dictionary_, row_;
  Owned<ZSTD_CCtx> compressor_;
  Owned<ZSTD_CDict> encoding_;  // read by the compressor
  Owned<ZSTD_DDict> decoding_;
};

}  // namespace

std::array<Codec, 2> zstd_row_baselines() {
  return {
      row_codec<ZstdRows<false>>("zstd-rows", "each row's bitmap through zstd -19", Origin::baseline),
      row_codec<ZstdRows<true>>("zstd-dict", "trained dictionary; each row's bitmap through zstd -19 with it",
                                Origin::baseline)};
}

}  // namespace vismat
