// Any payload and node index, for every codec: it decodes to the shape asked for or is refused; what ours
// decode they encode to bytes that mean the same (others' compressors may take a tenth of a second for that).
//
//   the codec's name and a zero byte; 1 byte each: rows, columns or leaves, arity (of a tree of columns), bytes of index; the index, the payload
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "codecs/baselines/baseline_codecs.h"
#include "codecs/vmat/parts.h"
#include "codecs/vmat/row_source.h"
#include "tests/codecs/matrices.h"

namespace {

// What is decoded as a whole is decoded row by row, too.
void read_rows(const vismat::RowSource& rows, const vismat::VisibilityMatrix& matrix) try {
  vismat::RowBuffer<std::uint32_t> buffer;
  for (std::uint32_t r = matrix.shape().rows; r-- > 0;) {
    vismat::IdSink sink(buffer, matrix.shape().columns, matrix.ones());
    rows.read(r, buffer, sink);
    sink.finish();
    if (!std::ranges::equal(buffer.content(), matrix.row(r))) std::abort();
  }
} catch (const vismat::FormatError&) {
  std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace vismat;
  static const std::vector<Codec> codecs = all_codecs();
  const std::uint8_t* const zero = std::find(data, data + size, 0);
  const std::string_view name(reinterpret_cast<const char*>(data), static_cast<std::size_t>(zero - data));
  const Codec* const found = codec_named(name, codecs);
  if (found == nullptr || data + size - zero < 5) return 0;
  const Codec& codec = *found;
  size -= static_cast<std::size_t>(zero + 1 - data);
  data = zero + 1;
  Shape shape{data[0], data[1]};
  ObjectTree tree;
  if (codec.needs.tree == TreeOver::columns) {
    if (shape.columns > 0) tree = test::even_tree(shape.columns, 2 + data[2] % 30);
    shape.columns = tree.size();
  } else if (codec.needs.tree == TreeOver::rows && shape.rows > 0) {
    tree = test::even_tree(shape.rows, 2);
  }
  const auto rest = std::as_bytes(std::span(data + 4, size - 4));
  const auto index = rest.first(std::min<std::size_t>(data[3], rest.size())),
             payload = rest.subspan(index.size());
  const Side side{&tree, {}, {}};
  const Encoded input{{payload.begin(), payload.end()}, {index.begin(), index.end()}};
  try {
    const VisibilityMatrix matrix = decode(codec, input, shape, side);
    if (matrix.shape() != shape) std::abort();
    if (codec.open != nullptr) read_rows(*codec.open(Parts(input), shape, side), matrix);
    if (codec.origin == Origin::baseline) return 0;
    if (codec.slow_encode && size % 16 != 0) return 0;  // milliseconds each
    const Encoded again = codec.encode(matrix, side, {});
    if (decode(codec, again, shape, side) != matrix) std::abort();
  } catch (const FormatError&) {
  }
  return 0;
}
