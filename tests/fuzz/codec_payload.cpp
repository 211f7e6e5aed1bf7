// Any payload and node index, for every codec: it decodes to the shape asked for or is refused; what ours
// decode they encode to bytes that mean the same (others' compressors may take a tenth of a second for that).
//
//   the codec's name and a zero byte; 1 byte each: rows, columns or leafs, arity (of a tree of columns), bytes of index; the index, the payload
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "codecs/baseline_codecs.h"
#include "tests/codecs/matrices.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace vismat;
  static const std::vector<Codec> codecs = all_codecs();
  const std::uint8_t* const zero = std::find(data, data + size, 0);
  const std::string_view name(reinterpret_cast<const char*>(data), static_cast<std::size_t>(zero - data));
  const auto codec_at =
      std::find_if(codecs.begin(), codecs.end(), [&](const Codec& c) { return c.name == name; });
  if (codec_at == codecs.end() || data + size - zero < 5) return 0;
  const Codec& codec = *codec_at;
  size -= static_cast<std::size_t>(zero + 1 - data);
  data = zero + 1;
  Shape shape{data[0], data[1]};
  ObjectTree tree;
  if (codec.over_tree == TreeOver::columns) {
    if (shape.columns > 0) tree = test::even_tree(shape.columns, 2 + data[2] % 30);
    shape.columns = tree.size();
  } else if (codec.over_tree == TreeOver::rows && shape.rows > 0) {
    tree = test::even_tree(shape.rows, 2);
  }
  const auto rest = std::as_bytes(std::span(data + 4, size - 4));
  const auto index = rest.first(std::min<std::size_t>(data[3], rest.size()));
  try {
    const VisibilityMatrix matrix = codec.decode(rest.subspan(index.size()), index, shape, &tree);
    if (matrix.shape() != shape) std::abort();
    const auto ours = own_codecs();
    if (std::none_of(ours.begin(), ours.end(), [&](const Codec& c) { return c.name == codec.name; }))
      return 0;
    const bool searches = codec.name == "panne" || codec.name == "gotsman3-context";
    if (searches && size % 16 != 0) return 0;  // milliseconds each
    const Encoded again = codec.encode(matrix, &tree);
    if (codec.decode(again.payload, again.index, shape, &tree) != matrix) std::abort();
  } catch (const FormatError&) {
  }
  return 0;
}
