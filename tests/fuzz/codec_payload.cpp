// Any payload and node index, for every codec: it decodes to the shape asked for or is refused.
//
//   byte 0 codec, 1 rows, 2 columns or leafs, 3 arity, 4 bytes of node index; then the index, then the
//   payload
#include <cstdint>
#include <cstdlib>

#include "codecs/baseline_codecs.h"
#include "tests/codecs/matrices.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace vismat;
  if (size < 5) return 0;
  static const std::vector<Codec> codecs = all_codecs();
  const Codec& codec = codecs[data[0] % codecs.size()];
  Shape shape{data[1], data[2]};
  const ObjectTree tree =
      codec.over_tree && shape.columns > 0 ? test::even_tree(shape.columns, 2 + data[3] % 30) : ObjectTree{};
  if (codec.over_tree) shape.columns = tree.size();
  const auto rest = std::as_bytes(std::span(data + 5, size - 5));
  const auto index = rest.first(std::min<std::size_t>(data[4], rest.size()));
  try {
    const VisibilityMatrix matrix = codec.decode(rest.subspan(index.size()), index, shape, &tree);
    if (matrix.shape() != shape) std::abort();
    const Encoded again = codec.encode(matrix, &tree);
    if (codec.decode(again.payload, again.node_index, shape, &tree) != matrix) std::abort();
  } catch (const FormatError&) {
  }
  return 0;
}
