// gzip and bzip2 over the bitmap, by zlib and libbz2. Decoders stop one byte past the size that the shape
// claims, so a payload that would inflate to gigabytes costs no more than an honest one.
#include "codecs/baseline_codecs.h"

#include <bzlib.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <limits>
#include <stdexcept>
#include <string>

#include "codecs/bitmap.h"

namespace vismat {
namespace {

using Bytes = std::span<const std::byte>;
constexpr std::size_t step = std::size_t{1} << 30;  // both libraries count in 32 bits

// What one call of a library came to. None may be made after `failed`: libbz2 then runs over its own stack.
enum class Step { more, ended, failed };

// Both libraries share one shape of stream: next_in, avail_in, next_out, avail_out. `run(last)` gets the
// input in steps of at most 2^30 bytes, and room for output up to `most` bytes in all. True where the stream
// ended with the input.
template <typename Byte, typename Stream, typename Run>
bool pump(Stream& stream, Bytes in, std::vector<std::byte>& out, std::size_t most, const Run& run) {
  std::size_t taken = 0;
  for (;;) {
    const std::size_t before = out.size(), give = std::min(step, in.size() - taken);
    const std::size_t room = std::min({std::max<std::size_t>(before, 65536), step, most - before});
    out.resize(before + room);
    stream.next_in = const_cast<Byte*>(reinterpret_cast<const Byte*>(in.data() + taken));
    stream.avail_in = static_cast<unsigned>(give);
    stream.next_out = reinterpret_cast<Byte*>(out.data() + before);
    stream.avail_out = static_cast<unsigned>(room);
    const Step result = run(taken + give == in.size());
    const std::size_t used = give - stream.avail_in, made = room - stream.avail_out;
    taken += used;
    out.resize(before + made);
    if (result == Step::ended) return taken == in.size();
    if (result == Step::failed || (used == 0 && made == 0)) return false;
  }
}

Step zlib_step(int code) {
  return code == Z_STREAM_END ? Step::ended : code == Z_OK ? Step::more : Step::failed;
}
Step bzip2_step(int code) {
  return code == BZ_STREAM_END ? Step::ended : code >= 0 ? Step::more : Step::failed;
}

constexpr std::size_t unlimited = std::numeric_limits<std::size_t>::max();

Encoded gzip_encode(const VisibilityMatrix& matrix, const ObjectTree*) {
  const auto bitmap = bitmap_bytes(matrix);
  Encoded out;
  z_stream stream{};
  if (deflateInit2(&stream, 9, Z_DEFLATED, 15 + 16, 8, Z_DEFAULT_STRATEGY) != Z_OK) throw std::bad_alloc();
  pump<Bytef>(stream, bitmap, out.payload, unlimited,
              [&](bool last) { return zlib_step(deflate(&stream, last ? Z_FINISH : Z_NO_FLUSH)); });
  deflateEnd(&stream);
  return out;
}

VisibilityMatrix gzip_decode(Bytes payload, Bytes, Shape shape, const ObjectTree*) {
  std::vector<std::byte> bitmap;
  z_stream stream{};
  if (inflateInit2(&stream, 15 + 16) != Z_OK) throw std::bad_alloc();
  const bool whole = pump<Bytef>(stream, payload, bitmap, bitmap_size(shape) + 1,
                                 [&](bool) { return zlib_step(inflate(&stream, Z_NO_FLUSH)); });
  inflateEnd(&stream);
  if (!whole)
    throw FormatError("gzip: damaged, cut short, or not the " + std::to_string(bitmap_size(shape)) +
                      " bytes of its shape");
  return matrix_from_bitmap(bitmap, shape);
}

Encoded bzip2_encode(const VisibilityMatrix& matrix, const ObjectTree*) {
  const auto bitmap = bitmap_bytes(matrix);
  Encoded out;
  bz_stream stream{};
  if (BZ2_bzCompressInit(&stream, 9, 0, 0) != BZ_OK) throw std::bad_alloc();
  pump<char>(stream, bitmap, out.payload, unlimited,
             [&](bool last) { return bzip2_step(BZ2_bzCompress(&stream, last ? BZ_FINISH : BZ_RUN)); });
  BZ2_bzCompressEnd(&stream);
  return out;
}

VisibilityMatrix bzip2_decode(Bytes payload, Bytes, Shape shape, const ObjectTree*) {
  std::vector<std::byte> bitmap;
  bz_stream stream{};
  if (BZ2_bzDecompressInit(&stream, 0, 0) != BZ_OK) throw std::bad_alloc();
  const bool whole = pump<char>(stream, payload, bitmap, bitmap_size(shape) + 1,
                                [&](bool) { return bzip2_step(BZ2_bzDecompress(&stream)); });
  BZ2_bzDecompressEnd(&stream);
  if (!whole)
    throw FormatError("bzip2: damaged, cut short, or not the " + std::to_string(bitmap_size(shape)) +
                      " bytes of its shape");
  return matrix_from_bitmap(bitmap, shape);
}

constexpr Codec whole_file(std::string_view name, std::string_view contents, decltype(Codec::encode) encode,
                           decltype(Codec::decode) decode) {
  Codec codec{};
  codec.name = name;
  codec.contents = contents;
  codec.encode = encode;
  codec.decode = decode;
  return codec;
}

constexpr std::array table = {
    whole_file("gzip", "bitmap through gzip -9", gzip_encode, gzip_decode),
    whole_file("bzip2", "bitmap through bzip2 -9", bzip2_encode, bzip2_decode),
};

}  // namespace

std::span<const Codec> baseline_codecs() {
  return table;
}

std::vector<Codec> all_codecs() {
  std::vector<Codec> all(own_codecs().begin(), own_codecs().end());
  const auto first_of_paper =
      std::find_if(all.begin(), all.end(), [](const Codec& c) { return c.over_tree; });
  all.insert(first_of_paper, table.begin(), table.end());
  return all;
}

const Codec& find_codec(std::string_view name) {
  static const std::vector<Codec> all = all_codecs();
  std::string names;
  for (const Codec& codec : all) {
    if (codec.name == name) return codec;
    names += (names.empty() ? "" : ", ") + std::string(codec.name);
  }
  throw std::invalid_argument("no codec '" + std::string(name) + "'; there are " + names);
}

}  // namespace vismat
