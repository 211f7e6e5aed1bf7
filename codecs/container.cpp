#include "codecs/container.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstring>
#include <stdexcept>

#include "codecs/bit_stream.h"

namespace vismat {
namespace {

constexpr std::array<unsigned char, 8> magic = {0x89, 'V', 'M', 'A', 'T', '\r', '\n', 0x1a};
constexpr std::uint32_t version = 1;

template <typename Number>
void put(std::vector<std::byte>& out, Number value) {
  const auto* bytes = reinterpret_cast<const std::byte*>(&value);
  out.insert(out.end(), bytes, bytes + sizeof value);
}

void put_section(std::vector<std::byte>& out, std::span<const std::byte> bytes) {
  put(out, std::uint64_t{bytes.size()});
  out.insert(out.end(), bytes.begin(), bytes.end());
}

std::span<const std::byte> get_section(ByteReader& in) {
  const auto size = in.number<std::uint64_t>();
  if (size > in.left())
    in.fail("a section of " + std::to_string(size) + " bytes; " + std::to_string(in.left()) + " are left");
  return in.bytes(size);
}

std::string text(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}
std::span<const std::byte> bytes_of(const std::string& text) {
  return std::as_bytes(std::span(text));
}

// Parents as the step back from each node, objects as 0 for none or 1 + object: small numbers, one byte
// mostly.
std::vector<std::byte> tree_bytes(const ObjectTree& tree) {
  std::vector<std::byte> out;
  put_varint(out, tree.object_count());
  put_varint(out, tree.size());
  for (std::uint32_t n = 1; n < tree.size(); ++n) put_varint(out, n - tree.parent_of_node()[n]);
  for (const std::uint32_t object : tree.object_of_node())
    put_varint(out, object == ObjectTree::none ? 0 : std::uint64_t{object} + 1);
  return out;
}

std::uint32_t small_varint(ByteReader& in, const char* what) {
  const std::uint64_t value = in.varint();
  if (value > 0xffffffff) in.fail(std::string(what) + " " + std::to_string(value) + " does not fit 32 bits");
  return static_cast<std::uint32_t>(value);
}

ObjectTree tree_from_bytes(std::span<const std::byte> bytes) {
  ByteReader in(bytes, "tree section");
  const std::uint32_t objects = small_varint(in, "object count");
  const std::uint64_t size = in.varint();
  if (size > in.left()) in.fail(std::to_string(size) + " nodes in " + std::to_string(in.left()) + " bytes");
  std::vector<std::uint32_t> parents, objects_of_node;
  for (std::uint32_t n = 0; n < size; ++n) {
    const std::uint32_t back = n == 0 ? 0 : small_varint(in, "step to a parent");
    if (n > 0 && (back == 0 || back > n))
      in.fail("node " + std::to_string(n) + " has its parent " + std::to_string(back) + " back");
    parents.push_back(n == 0 ? ObjectTree::none : n - back);
  }
  for (std::uint32_t n = 0; n < size; ++n)
    objects_of_node.push_back(small_varint(in, "object") - 1);  // 0 becomes none
  if (in.left() != 0) in.fail("bytes after the last node");
  try {
    return ObjectTree::from_parents(std::move(parents), std::move(objects_of_node), objects);
  } catch (const std::invalid_argument& error) {
    throw FormatError(std::string("tree section: ") + error.what());
  }
}

}  // namespace

std::uint64_t container_checksum(std::span<const std::byte> bytes) {
  std::uint64_t sum = 0xcbf29ce484222325u;
  for (const std::byte b : bytes) sum = (sum ^ std::to_integer<std::uint64_t>(b)) * 0x100000001b3u;
  return sum;
}

std::vector<std::byte> write_container(const Container& container) {
  std::vector<std::byte> out;
  for (const unsigned char c : magic) out.push_back(static_cast<std::byte>(c));
  put(out, version);
  put(out, container.shape.rows);
  put(out, container.shape.columns);
  put(out, container.ones);
  put_section(out, bytes_of(container.codec));
  put_section(out, bytes_of(container.facts));
  put_section(out, container.tree ? tree_bytes(*container.tree) : std::vector<std::byte>{});
  std::vector<std::uint32_t> order;
  if (container.row_order)
    order.assign(container.row_order->new_of_old().begin(), container.row_order->new_of_old().end());
  put_section(out, std::as_bytes(std::span(order)));
  put_section(out, container.encoded.node_index);
  put_section(out, container.encoded.payload);
  put(out, container_checksum(out));
  return out;
}

Container read_container(std::span<const std::byte> bytes) {
  ByteReader in(bytes, ".vmat");
  if (bytes.size() < magic.size() || std::memcmp(bytes.data(), magic.data(), magic.size()) != 0) {
    in.fail("not a .vmat file: the magic number differs");
  }
  in.skip(magic.size());
  if (const auto found = in.number<std::uint32_t>(); found != version) {
    in.fail("version " + std::to_string(found) + "; this program reads version " + std::to_string(version));
  }
  if (in.left() < 8) in.fail("cut short");
  ByteReader last(bytes.last(8), ".vmat");
  if (container_checksum(bytes.first(bytes.size() - 8)) != last.number<std::uint64_t>()) {
    in.fail("the checksum differs: the file is damaged or cut short");
  }
  Container container;
  container.shape.rows = in.number<std::uint32_t>();
  container.shape.columns = in.number<std::uint32_t>();
  container.ones = in.number<std::uint64_t>();
  if (container.ones > std::uint64_t{container.shape.rows} * container.shape.columns)
    in.fail("more ones than the table has places");
  container.codec = text(get_section(in));
  container.facts = text(get_section(in));
  if (const auto tree = get_section(in); !tree.empty()) container.tree = tree_from_bytes(tree);
  if (const auto order = get_section(in); !order.empty()) {
    if (order.size() != std::size_t{container.shape.rows} * 4)
      in.fail("a row order of " + std::to_string(order.size()) + " bytes; need 4 a row");
    std::vector<std::uint32_t> map(container.shape.rows);
    std::memcpy(map.data(), order.data(), order.size());
    try {
      container.row_order = Permutation::from_new_of_old(std::move(map));
    } catch (const std::invalid_argument& error) {
      in.fail(std::string("row order: ") + error.what());
    }
  }
  const auto index = get_section(in), payload = get_section(in);
  container.encoded.node_index.assign(index.begin(), index.end());
  container.encoded.payload.assign(payload.begin(), payload.end());
  if (in.left() != 8) in.fail(std::to_string(in.left() - 8) + " bytes after the payload");
  return container;
}

Container compress(const VisibilityMatrix& matrix, const Codec& codec, const ObjectTree* tree,
                   const Permutation* row_order) {
  Container container;
  container.shape = matrix.shape();
  container.ones = matrix.ones();
  container.codec = codec.name;
  if (tree != nullptr) container.tree = *tree;
  if (row_order != nullptr) {
    container.row_order = *row_order;
    container.encoded =
        codec.encode(permute(matrix, *row_order, Permutation::identity(matrix.shape().columns)), tree);
  } else {
    container.encoded = codec.encode(matrix, tree);
  }
  return container;
}

VisibilityMatrix decompress(const Container& container, const Codec& codec) {
  assert(container.codec == codec.name);
  VisibilityMatrix matrix = codec.decode(container.encoded.payload, container.encoded.node_index,
                                         container.shape, container.tree ? &*container.tree : nullptr);
  if (matrix.ones() != container.ones) {
    throw FormatError("the payload holds " + std::to_string(matrix.ones()) + " ones; the file states " +
                      std::to_string(container.ones));
  }
  if (!container.row_order) return matrix;
  return permute(matrix, container.row_order->inverse(), Permutation::identity(container.shape.columns));
}

}  // namespace vismat
