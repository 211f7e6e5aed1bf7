// Codecs whose payload is one piece that is decoded as a whole.
#pragma once
#include <string>
#include <string_view>

#include "codecs/codec.h"
#include "codecs/vmat/parts.h"

namespace vismat {

/// encode_all(matrix) returns an Encoded without an index. decode_all(bytes, shape) returns the matrix, or throws
/// FormatError.
template <auto encode_all, auto decode_all>
constexpr Codec whole_file_codec(std::string_view name, std::string_view contents, Origin origin) {
  Codec codec{.name = name, .contents = contents, .origin = origin};
  codec.encode = [](const VisibilityMatrix& matrix, const Side&, const EncodeOptions&) {
    return encode_all(matrix);
  };
  codec.decode = [](const Parts& parts, Shape shape, const Side&, std::uint64_t most) {
    VisibilityMatrix matrix = decode_all(parts.whole(), shape);
    if (matrix.ones() > most) throw FormatError("more ones than the file states");
    return matrix;
  };
  return codec;
}

}  // namespace vismat
