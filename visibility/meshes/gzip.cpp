#include "visibility/meshes/gzip.h"

#include <zlib.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <new>
#include <string>
#include <utility>

#include "matrix/base/byte_reader.h"

namespace vismat {
namespace {

struct EndInflate {
  void operator()(z_stream* stream) const { inflateEnd(stream); }
};

}  // namespace

bool is_gzip(std::span<const std::byte> bytes) {
  return bytes.size() >= 2 && bytes[0] == std::byte{0x1F} && bytes[1] == std::byte{0x8B};
}

Gunzipped gunzipped(std::span<const std::byte> bytes) {
  constexpr std::size_t step = std::size_t{1} << 20;
  const std::size_t most = 16 * step + 100 * bytes.size();
  z_stream stream{};
  if (inflateInit2(&stream, 16 + MAX_WBITS) != Z_OK) throw std::bad_alloc();  // 16: gzip alone
  const std::unique_ptr<z_stream, EndInflate> end(&stream);
  std::vector<std::byte> result;
  std::size_t size = 0, at = 0;
  while (is_gzip(bytes.subspan(at))) {
    inflateReset(&stream);
    for (int status = Z_OK; status != Z_STREAM_END;) {
      if (size == result.size()) {
        if (size >= most) {
          throw FormatError("is a gzip file that unpacks to more than " + std::to_string(most) +
                            " bytes, over 100 times its size; unpack it by gunzip if that is right");
        }
        result.resize(size + std::min({std::max(step, size), most - size}));
      }
      constexpr std::size_t most_at_once = std::numeric_limits<uInt>::max();
      const std::size_t in = std::min(bytes.size() - at, most_at_once),
                        out = std::min(result.size() - size, most_at_once);
      stream.next_in = reinterpret_cast<Bytef*>(const_cast<std::byte*>(bytes.data() + at));
      stream.avail_in = static_cast<uInt>(in);
      stream.next_out = reinterpret_cast<Bytef*>(result.data() + size);
      stream.avail_out = static_cast<uInt>(out);
      status = inflate(&stream, Z_NO_FLUSH);
      at += in - stream.avail_in;
      size += out - stream.avail_out;
      if (status == Z_MEM_ERROR) throw std::bad_alloc();
      if (status == Z_BUF_ERROR || (status == Z_OK && at == bytes.size() && stream.avail_out > 0)) {
        throw FormatError("is a gzip file that is cut short");
      }
      if (status != Z_OK && status != Z_STREAM_END) {
        throw FormatError("is a damaged gzip file: " +
                          std::string(stream.msg != nullptr ? stream.msg : "no data"));
      }
    }
  }
  result.resize(size);
  return {std::move(result), bytes.size() - at};
}

}  // namespace vismat
