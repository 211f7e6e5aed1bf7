// The whole-file codecs: the bitmap through general-purpose compressors, each at its best setting. Decoders stop one
// byte past the size that the shape claims, and refuse windows and dictionaries much larger than that. So a payload
// that would inflate to gigabytes costs no more than an honest one.
#include <brotli/decode.h>
#include <brotli/encode.h>
#include <bzlib.h>
#include <lzma.h>
#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <bit>
#include <limits>
#include <memory>
#include <new>
#include <stdexcept>
#include <string>

#include "codecs/baselines/baseline_parts.h"
#include "codecs/baselines/whole_file_codec.h"
#include "codecs/rows/bitmap.h"

namespace vismat {
namespace {

using Bytes = std::span<const std::byte>;
using Room = std::span<std::byte>;

// What one call of a library came to. None may be made after `failed`: libbz2 then runs over its own stack.
enum class Step { more, ended, failed };

// run(in, room) takes from the front of both what it uses. True where the stream ended with the input; output is cut off
// at `most` bytes.
template <typename Run>
bool pump(Bytes in, std::vector<std::byte>& out, std::size_t most, const Run& run) {
  for (;;) {
    const std::size_t before = out.size(), given = in.size();
    out.resize(before + std::min(std::max<std::size_t>(before, 65536), most - before));
    Room room = Room(out).subspan(before);
    const Step result = run(in, room);
    out.resize(out.size() - room.size());
    if (result == Step::ended) return in.empty();
    if (result == Step::failed || (in.size() == given && out.size() == before)) return false;
  }
}

// zlib, libbz2 and liblzma share one shape of stream. call(last): whether this is all of the input.
template <typename Stream, typename Call>
auto step(Stream& stream, Bytes& in, Room& room, const Call& call) {
  constexpr std::size_t most = std::size_t{1} << 30;  // two of them count in 32 bits
  const std::size_t give = std::min(most, in.size()), take = std::min(most, room.size());
  stream.next_in = reinterpret_cast<decltype(stream.next_in)>(const_cast<std::byte*>(in.data()));
  stream.avail_in = static_cast<decltype(stream.avail_in)>(give);
  stream.next_out = reinterpret_cast<decltype(stream.next_out)>(room.data());
  stream.avail_out = static_cast<decltype(stream.avail_out)>(take);
  const auto result = call(give == in.size());
  in = in.subspan(give - stream.avail_in);
  room = room.subspan(take - stream.avail_out);
  return result;
}

template <typename Stream>
using Open = std::unique_ptr<Stream, void (*)(Stream*)>;

constexpr std::size_t unlimited = std::numeric_limits<std::size_t>::max();

VisibilityMatrix matrix_or_refuse(bool whole, const std::vector<std::byte>& bitmap, Shape shape,
                                  const char* codec) {
  if (!whole)
    throw FormatError(std::string(codec) + ": damaged, cut short, or not the " +
                      std::to_string(bitmap_size(shape)) + " bytes of its shape");
  return matrix_from_bitmap(bitmap, shape);
}

void encoded_or_throw(bool whole, const char* codec) {
  if (!whole) throw std::runtime_error(std::string(codec) + ": its library failed");
}

// --- gzip -9

Step zlib_step(int code) {
  return code == Z_STREAM_END ? Step::ended : code == Z_OK ? Step::more : Step::failed;
}

Encoded gzip_encode(const VisibilityMatrix& matrix) {
  Encoded out;
  z_stream stream{};
  if (deflateInit2(&stream, 9, Z_DEFLATED, 15 + 16, 8, Z_DEFAULT_STRATEGY) != Z_OK) throw std::bad_alloc();
  const Open<z_stream> open(&stream, [](z_stream* s) { deflateEnd(s); });
  const bool whole = pump(bitmap_bytes(matrix), out.payload, unlimited, [&](Bytes& in, Room& room) {
    return zlib_step(
        step(stream, in, room, [&](bool last) { return deflate(&stream, last ? Z_FINISH : Z_NO_FLUSH); }));
  });
  encoded_or_throw(whole, "gzip");
  return out;
}

VisibilityMatrix gzip_decode(Bytes payload, Shape shape) {
  std::vector<std::byte> bitmap;
  z_stream stream{};
  if (inflateInit2(&stream, 15 + 16) != Z_OK) throw std::bad_alloc();
  const Open<z_stream> open(&stream, [](z_stream* s) { inflateEnd(s); });
  const bool whole = pump(payload, bitmap, bitmap_size(shape) + 1, [&](Bytes& in, Room& room) {
    return zlib_step(step(stream, in, room, [&](bool) { return inflate(&stream, Z_NO_FLUSH); }));
  });
  return matrix_or_refuse(whole, bitmap, shape, "gzip");
}

// --- bzip2 -9

Step bzip2_step(int code) {
  return code == BZ_STREAM_END ? Step::ended : code >= 0 ? Step::more : Step::failed;
}

Encoded bzip2_encode(const VisibilityMatrix& matrix) {
  Encoded out;
  bz_stream stream{};
  if (BZ2_bzCompressInit(&stream, 9, 0, 0) != BZ_OK) throw std::bad_alloc();
  const Open<bz_stream> open(&stream, [](bz_stream* s) { BZ2_bzCompressEnd(s); });
  const bool whole = pump(bitmap_bytes(matrix), out.payload, unlimited, [&](Bytes& in, Room& room) {
    return bzip2_step(step(stream, in, room,
                           [&](bool last) { return BZ2_bzCompress(&stream, last ? BZ_FINISH : BZ_RUN); }));
  });
  encoded_or_throw(whole, "bzip2");
  return out;
}

VisibilityMatrix bzip2_decode(Bytes payload, Shape shape) {
  std::vector<std::byte> bitmap;
  bz_stream stream{};
  if (BZ2_bzDecompressInit(&stream, 0, 0) != BZ_OK) throw std::bad_alloc();
  const Open<bz_stream> open(&stream, [](bz_stream* s) { BZ2_bzDecompressEnd(s); });
  const bool whole = pump(payload, bitmap, bitmap_size(shape) + 1, [&](Bytes& in, Room& room) {
    return bzip2_step(step(stream, in, room, [&](bool) { return BZ2_bzDecompress(&stream); }));
  });
  return matrix_or_refuse(whole, bitmap, shape, "bzip2");
}

// --- xz -9e, but with a dictionary no larger than the data: it finds the same, and a decoder needs no 64 MiB

Step lzma_step(lzma_ret code) {
  return code == LZMA_STREAM_END ? Step::ended : code == LZMA_OK ? Step::more : Step::failed;
}

Encoded xz_encode(const VisibilityMatrix& matrix) {
  const auto bitmap = bitmap_bytes(matrix);
  lzma_options_lzma options;
  if (lzma_lzma_preset(&options, 9 | LZMA_PRESET_EXTREME)) throw std::logic_error("xz: no preset -9e");
  options.dict_size = static_cast<std::uint32_t>(
      std::clamp<std::size_t>(bitmap.size(), LZMA_DICT_SIZE_MIN, options.dict_size));
  const lzma_filter filters[] = {{LZMA_FILTER_LZMA2, &options}, {LZMA_VLI_UNKNOWN, nullptr}};
  Encoded out;
  lzma_stream stream = LZMA_STREAM_INIT;
  const Open<lzma_stream> open(&stream, [](lzma_stream* s) { lzma_end(s); });
  if (lzma_stream_encoder(&stream, filters, LZMA_CHECK_CRC64) != LZMA_OK) throw std::bad_alloc();
  const bool whole = pump(bitmap, out.payload, unlimited, [&](Bytes& in, Room& room) {
    return lzma_step(
        step(stream, in, room, [&](bool last) { return lzma_code(&stream, last ? LZMA_FINISH : LZMA_RUN); }));
  });
  encoded_or_throw(whole, "xz");
  return out;
}

VisibilityMatrix xz_decode(Bytes payload, Shape shape) {
  // Dictionary sizes are stored as 2^n or 3 * 2^n, so up to 1.5 times the bitmap's; the rest is the decoder itself.
  const std::uint64_t memory = bitmap_size(shape) + bitmap_size(shape) / 2 + (1 << 20);
  std::vector<std::byte> bitmap;
  lzma_stream stream = LZMA_STREAM_INIT;
  const Open<lzma_stream> open(&stream, [](lzma_stream* s) { lzma_end(s); });
  if (lzma_stream_decoder(&stream, memory, 0) != LZMA_OK) throw std::bad_alloc();
  const bool whole = pump(payload, bitmap, bitmap_size(shape) + 1, [&](Bytes& in, Room& room) {
    return lzma_step(
        step(stream, in, room, [&](bool last) { return lzma_code(&stream, last ? LZMA_FINISH : LZMA_RUN); }));
  });
  return matrix_or_refuse(whole, bitmap, shape, "xz");
}

// --- zstd -19 --long, with a checksum as the program writes; where 2^27 bytes are less than the bitmap, a window over all
// of it

int window_log(std::uint64_t bytes, int least) {
  return std::clamp(static_cast<int>(std::bit_width(bytes)), least, 31);
}

Encoded zstd_encode(const VisibilityMatrix& matrix) {
  const auto bitmap = bitmap_bytes(matrix);
  const std::unique_ptr<ZSTD_CCtx, std::size_t (*)(ZSTD_CCtx*)> context(ZSTD_createCCtx(), ZSTD_freeCCtx);
  if (context == nullptr) throw std::bad_alloc();
  const auto done = [](std::size_t result) {
    if (ZSTD_isError(result)) throw std::runtime_error(std::string("zstd: ") + ZSTD_getErrorName(result));
    return result;
  };
  done(ZSTD_CCtx_setParameter(context.get(), ZSTD_c_compressionLevel, 19));
  done(ZSTD_CCtx_setParameter(context.get(), ZSTD_c_enableLongDistanceMatching, 1));
  done(ZSTD_CCtx_setParameter(context.get(), ZSTD_c_windowLog, window_log(bitmap.size(), 27)));
  done(ZSTD_CCtx_setParameter(context.get(), ZSTD_c_checksumFlag, 1));
  Encoded out;
  out.payload.resize(ZSTD_compressBound(bitmap.size()));
  out.payload.resize(done(
      ZSTD_compress2(context.get(), out.payload.data(), out.payload.size(), bitmap.data(), bitmap.size())));
  return out;
}

VisibilityMatrix zstd_decode(Bytes payload, Shape shape) {
  const std::unique_ptr<ZSTD_DCtx, std::size_t (*)(ZSTD_DCtx*)> context(ZSTD_createDCtx(), ZSTD_freeDCtx);
  if (context == nullptr) throw std::bad_alloc();
  ZSTD_DCtx_setParameter(context.get(), ZSTD_d_windowLogMax, window_log(bitmap_size(shape), 10));
  std::vector<std::byte> bitmap;
  const bool whole = pump(payload, bitmap, bitmap_size(shape) + 1, [&](Bytes& in, Room& room) {
    ZSTD_inBuffer from{in.data(), in.size(), 0};
    ZSTD_outBuffer to{room.data(), room.size(), 0};
    const std::size_t result = ZSTD_decompressStream(context.get(), &to, &from);
    in = in.subspan(from.pos);
    room = room.subspan(to.pos);
    return ZSTD_isError(result) ? Step::failed : result == 0 ? Step::ended : Step::more;
  });
  return matrix_or_refuse(whole, bitmap, shape, "zstd");
}

// --- brotli -q 11 --lgwin=24: the largest window of RFC 7932

Encoded brotli_encode(const VisibilityMatrix& matrix) {
  const auto bitmap = bitmap_bytes(matrix);
  Encoded out;
  std::size_t size = BrotliEncoderMaxCompressedSize(bitmap.size());
  out.payload.resize(size);
  const bool whole =
      BrotliEncoderCompress(BROTLI_MAX_QUALITY, BROTLI_MAX_WINDOW_BITS, BROTLI_MODE_GENERIC, bitmap.size(),
                            reinterpret_cast<const std::uint8_t*>(bitmap.data()), &size,
                            reinterpret_cast<std::uint8_t*>(out.payload.data()));
  encoded_or_throw(whole, "brotli");
  out.payload.resize(size);
  return out;
}

VisibilityMatrix brotli_decode(Bytes payload, Shape shape) {
  const Open<BrotliDecoderState> state(BrotliDecoderCreateInstance(nullptr, nullptr, nullptr),
                                       BrotliDecoderDestroyInstance);
  if (state == nullptr) throw std::bad_alloc();
  std::vector<std::byte> bitmap;
  const bool whole = pump(payload, bitmap, bitmap_size(shape) + 1, [&](Bytes& in, Room& room) {
    auto* from = reinterpret_cast<const std::uint8_t*>(in.data());
    auto* to = reinterpret_cast<std::uint8_t*>(room.data());
    std::size_t give = in.size(), take = room.size();
    const BrotliDecoderResult result =
        BrotliDecoderDecompressStream(state.get(), &give, &from, &take, &to, nullptr);
    in = in.last(give);
    room = room.last(take);
    return result == BROTLI_DECODER_RESULT_SUCCESS             ? Step::ended
           : result == BROTLI_DECODER_RESULT_NEEDS_MORE_OUTPUT ? Step::more
                                                               : Step::failed;
  });
  return matrix_or_refuse(whole, bitmap, shape, "brotli");
}

}  // namespace

std::array<Codec, 5> whole_file_baselines() {
  return {
      whole_file_codec<gzip_encode, gzip_decode>("gzip", "bitmap through gzip -9", Origin::baseline),
      whole_file_codec<bzip2_encode, bzip2_decode>("bzip2", "bitmap through bzip2 -9", Origin::baseline),
      whole_file_codec<xz_encode, xz_decode>("xz", "bitmap through xz -9e", Origin::baseline),
      whole_file_codec<zstd_encode, zstd_decode>("zstd", "bitmap through zstd -19 --long", Origin::baseline),
      whole_file_codec<brotli_encode, brotli_decode>("brotli", "bitmap through brotli -q 11 --lgwin=24",
                                                     Origin::baseline),
  };
}

}  // namespace vismat
