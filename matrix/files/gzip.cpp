#include "matrix/files/gzip.h"

#include <zlib.h>

#include <algorithm>
#include <limits>
#include <string>

#include "matrix/base/byte_reader.h"

namespace vismat {

bool is_gzip(std::span<const std::byte> bytes) {
  return bytes.size() >= 2 && bytes[0] == std::byte{0x1f} && bytes[1] == std::byte{0x8b};
}

std::uint64_t most_unpacked(std::uint64_t packed) {
  return std::max(std::uint64_t{1} << 30, 200 * packed);
}

std::vector<std::byte> gunzip(std::span<const std::byte> packed, std::uint64_t most,
                              std::uint64_t* after_end) {
  struct Stream {
    z_stream z = {};
    Stream() {
      constexpr int gzip_alone = 16;
      if (inflateInit2(&z, MAX_WBITS + gzip_alone) != Z_OK) throw std::bad_alloc();
    }
    ~Stream() { inflateEnd(&z); }
  } stream;
  z_stream& z = stream.z;
  std::vector<std::byte> out;
  std::size_t have = 0;
  while (is_gzip(packed)) {
    inflateReset(&z);
    for (int code = Z_OK; code != Z_STREAM_END;) {
      if (have == out.size()) {
        out.resize(std::min(std::max<std::uint64_t>(2 * have, 1 << 16), most + 1));
      }
      constexpr std::size_t at_once = std::numeric_limits<uInt>::max();
      z.next_in = reinterpret_cast<Bytef*>(const_cast<std::byte*>(packed.data()));
      z.avail_in = static_cast<uInt>(std::min(packed.size(), at_once));
      z.next_out = reinterpret_cast<Bytef*>(out.data() + have);
      z.avail_out = static_cast<uInt>(std::min(out.size() - have, at_once));
      const uInt in = z.avail_in, room = z.avail_out;
      code = inflate(&z, Z_NO_FLUSH);
      packed = packed.subspan(in - z.avail_in);
      have += room - z.avail_out;
      if (have > most) {
        throw FormatError(
            "gzip: unpacks to more than " + std::to_string(most) +
            " bytes, far more than files of this size do; unpack it with gunzip if that is right");
      }
      if (code == Z_OK || code == Z_STREAM_END) continue;
      if (code == Z_BUF_ERROR && packed.empty())
        throw FormatError("gzip: ends early, after " + std::to_string(have) + " unpacked bytes");
      throw FormatError("gzip: is damaged after " + std::to_string(have) + " unpacked bytes");
    }
  }
  const auto zero = [](std::byte b) { return b == std::byte{0}; };  // tapes pad with them
  if (after_end != nullptr) {
    *after_end = packed.size();
  } else if (!std::all_of(packed.begin(), packed.end(), zero))
    throw FormatError("gzip: " + std::to_string(packed.size()) + " bytes of something else follow");
  out.resize(have);
  return out;
}

}  // namespace vismat
