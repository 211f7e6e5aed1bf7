#include "codecs/container.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cstring>
#include <stdexcept>
#include <utility>

#include "codecs/bit_stream.h"
#include "codecs/checksum.h"
#include "codecs/row_codec.h"
#include "matrix/claimed_shape.h"

namespace vismat {
namespace {

constexpr std::array<unsigned char, 8> magic = {0x89, 'V', 'M', 'A', 'T', '\r', '\n', 0x1a};
constexpr std::uint32_t version = 2;
constexpr std::size_t name_bytes = 32;
// magic, version, rows, columns, ones, codec, sizes of the sections, checksum of the blocks' checksums, of the head
constexpr std::size_t head_bytes = 8 + 4 + 4 + 4 + 8 + name_bytes + 8 * ContainerHead::sections + 4 + 4;
static_assert(head_bytes % 4 == 0);

template <typename Number>
void put(std::vector<std::byte>& out, Number value) {
  const auto* bytes = reinterpret_cast<const std::byte*>(&value);
  out.insert(out.end(), bytes, bytes + sizeof value);
}
void store(std::span<std::byte> out, std::size_t at, std::uint32_t value) {
  std::memcpy(out.data() + at, &value, sizeof value);
}
std::uint32_t load(std::span<const std::byte> bytes, std::size_t at) {
  std::uint32_t value;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

// The size of the body that the head tells, where file = head, a checksum for each block, body; nullopt if there is none.
std::optional<std::uint64_t> body_bytes(std::span<const std::byte> file) {
  ByteReader in(file, ".vmat");
  in.skip(head_bytes - 8 - 8 * ContainerHead::sections);
  std::uint64_t body = 0;
  for (int s = 0; s < ContainerHead::sections; ++s) {
    const auto size = in.number<std::uint64_t>();
    if (size > file.size() - body) return std::nullopt;  // also where the sum would overflow
    body += size;
  }
  const std::uint64_t blocks = (body + ContainerHead::block_bytes - 1) / ContainerHead::block_bytes;
  if (head_bytes + 4 * blocks + body != file.size()) return std::nullopt;
  return body;
}

std::span<const std::byte> block_of(std::span<const std::byte> body, std::uint64_t block) {
  const std::uint64_t begin = block * ContainerHead::block_bytes;
  return body.subspan(begin, std::min(ContainerHead::block_bytes, body.size() - begin));
}

std::string text(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
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

// As many bits a place as the largest one needs.
unsigned place_bits(std::uint32_t size) {
  return size < 2 ? 0 : static_cast<unsigned>(std::bit_width(size - 1));
}

std::vector<std::byte> order_bytes(const std::optional<Permutation>& order) {
  std::vector<std::byte> out;
  if (!order) return out;
  BitWriter bits(out);
  for (const std::uint32_t place : order->new_of_old()) bits.put(place, place_bits(order->size()));
  bits.flush();
  return out;
}

// Boundaries ascend, those from outside first: how many these are, each step between their cells; then of each of the others
// the step from the last one's first cell and the step to its second.
std::vector<std::byte> boundary_bytes(std::span<const Boundary> boundaries) {
  std::vector<std::byte> out;
  if (boundaries.empty()) return out;
  std::size_t outside = 0;
  while (outside < boundaries.size() && boundaries[outside].from == Boundary::outside) ++outside;
  put_varint(out, outside);
  std::uint32_t last = 0;
  for (const Boundary& b : boundaries.first(outside)) put_varint(out, b.to - std::exchange(last, b.to));
  last = 0;
  for (const Boundary& b : boundaries.subspan(outside)) {
    put_varint(out, b.from - std::exchange(last, b.from));
    put_varint(out, b.to - b.from);
  }
  return out;
}

}  // namespace

std::vector<Boundary> boundaries_from_bytes(std::span<const std::byte> bytes, std::uint32_t rows) {
  std::vector<Boundary> boundaries;
  if (bytes.empty()) return boundaries;
  ByteReader in(bytes, "boundary section");
  const auto cell = [&](std::uint64_t from, std::uint64_t step) {
    if (step >= Boundary::outside - from) in.fail("a cell of more than 32 bits");
    return static_cast<std::uint32_t>(from + step);
  };
  const std::uint64_t outside = in.varint();
  if (in.left() == 0) in.fail("no boundary");
  if (outside > in.left())
    in.fail(std::to_string(outside) + " boundaries from outside in " + std::to_string(in.left()) + " bytes");
  std::uint32_t last = 0;
  for (std::uint64_t i = 0; i < outside; ++i) {
    last = cell(last, in.varint());
    boundaries.push_back({Boundary::outside, last});
  }
  last = 0;
  while (in.left() > 0) {
    last = cell(last, in.varint());
    boundaries.push_back({last, cell(last, in.varint())});
  }
  if (2 * std::uint64_t{boundaries.size()} != rows) {
    in.fail(std::to_string(boundaries.size()) + " boundaries for " + std::to_string(rows) +
            " rows; there are two rows a boundary");
  }
  try {
    BoundaryMap{boundaries};
  } catch (const std::invalid_argument& error) {
    in.fail(error.what());
  }
  return boundaries;
}

std::optional<Permutation> order_from_bytes(std::span<const std::byte> bytes, std::uint32_t size) {
  if (bytes.empty()) return std::nullopt;
  const std::uint64_t need = (std::uint64_t{size} * place_bits(size) + 7) / 8;
  if (bytes.size() != need) {
    throw FormatError("an order of " + std::to_string(bytes.size()) + " bytes; " + std::to_string(size) +
                      " places take " + std::to_string(need));
  }
  BitReader bits(bytes);
  std::vector<std::uint32_t> map(size);
  for (std::uint32_t& place : map) place = bits.get(place_bits(size));
  bits.finish();
  try {
    return Permutation::from_new_of_old(std::move(map));
  } catch (const std::invalid_argument& error) {
    throw FormatError(std::string("order section: ") + error.what());
  }
}

ContainerHead::ContainerHead(std::span<const std::byte> file) {
  ByteReader in(file, ".vmat");
  if (file.size() < magic.size() || std::memcmp(file.data(), magic.data(), magic.size()) != 0)
    in.fail("not a .vmat file: the magic number differs");
  in.skip(magic.size());
  if (const auto found = in.number<std::uint32_t>(); found != version)
    in.fail("version " + std::to_string(found) + "; this program reads version " + std::to_string(version));
  if (file.size() < head_bytes) in.fail("cut short: a head takes " + std::to_string(head_bytes) + " bytes");
  if (crc32(file.first(head_bytes - 4)) != load(file, head_bytes - 4))
    in.fail("the head's checksum differs: the file is damaged");
  const auto body = body_bytes(file);
  if (!body)
    in.fail("the file has " + std::to_string(file.size()) +
            " bytes, not what its head tells: cut short or damaged");

  shape.rows = in.number<std::uint32_t>();
  shape.columns = in.number<std::uint32_t>();
  ones = in.number<std::uint64_t>();
  if (ones > std::uint64_t{shape.rows} * shape.columns) in.fail("more ones than the matrix has places");
  codec = text(in.bytes(name_bytes));
  const std::size_t name_end = std::min(codec.find('\0'), codec.size());
  if (codec.find_first_not_of('\0', name_end) != std::string::npos) in.fail("bytes behind the codec's name");
  codec.resize(name_end);
  body_ = file.last(*body);
  sums_ = file.subspan(head_bytes, file.size() - *body - head_bytes);
  std::uint64_t at = 0;
  for (auto& section : section_) {
    const auto size = in.number<std::uint64_t>();
    section = body_.subspan(at, size);
    at += size;
  }
  if (crc32(sums_) != in.number<std::uint32_t>())
    in.fail("the checksum of checksums differs: the file is damaged");
}

void ContainerHead::check_block(std::uint64_t block) const {
  if (crc32(block_of(body_, block)) != load(sums_, 4 * block)) {
    throw FormatError(".vmat: the checksum of bytes " + std::to_string(block * block_bytes) + " on of " +
                      std::to_string(body_.size()) + " of the body differs: the file is damaged");
  }
}

void seal_container(std::span<std::byte> file) {
  if (file.size() < head_bytes) return;
  const auto body = body_bytes(file);
  if (!body) return;
  const auto sums = file.subspan(head_bytes, file.size() - *body - head_bytes);
  for (std::uint64_t b = 0; b < sums.size() / 4; ++b)
    store(sums, 4 * b, crc32(block_of(file.last(*body), b)));
  store(file, head_bytes - 8, crc32(sums));
  store(file, head_bytes - 4, crc32(file.first(head_bytes - 4)));
}

std::vector<std::byte> write_container(const Container& container) {
  assert(container.codec.size() <= name_bytes);
  const std::vector<std::byte> tree = container.tree ? tree_bytes(*container.tree) : std::vector<std::byte>{},
                               rows = order_bytes(container.row_order),
                               columns = order_bytes(container.column_order),
                               boundaries = boundary_bytes(container.boundaries);
  const std::array<std::span<const std::byte>, ContainerHead::sections> sections = {
      std::as_bytes(std::span(container.facts)),
      tree,
      rows,
      columns,
      boundaries,
      container.encoded.index,
      container.encoded.payload};
  std::vector<std::byte> out;
  for (const unsigned char c : magic) out.push_back(static_cast<std::byte>(c));
  put(out, version);
  put(out, container.shape.rows);
  put(out, container.shape.columns);
  put(out, container.ones);
  for (std::size_t i = 0; i < name_bytes; ++i)
    put(out, i < container.codec.size() ? container.codec[i] : '\0');
  std::uint64_t body = 0;
  for (const auto section : sections) {
    put(out, std::uint64_t{section.size()});
    body += section.size();
  }
  out.resize(head_bytes + 4 * ((body + ContainerHead::block_bytes - 1) / ContainerHead::block_bytes));
  out.reserve(out.size() + body);
  for (const auto section : sections) out.insert(out.end(), section.begin(), section.end());
  seal_container(out);
  return out;
}

Container read_container(std::span<const std::byte> bytes) {
  const ContainerHead head(bytes);
  for (std::uint64_t b = 0; b < head.blocks(); ++b) head.check_block(b);
  Container container;
  container.shape = head.shape;
  container.ones = head.ones;
  container.codec = head.codec;
  container.facts = text(head.section(ContainerHead::facts));
  if (const auto tree = head.section(ContainerHead::tree); !tree.empty())
    container.tree = tree_from_bytes(tree);
  container.row_order = order_from_bytes(head.section(ContainerHead::row_order), head.shape.rows);
  container.column_order = order_from_bytes(head.section(ContainerHead::column_order), head.shape.columns);
  container.boundaries = boundaries_from_bytes(head.section(ContainerHead::boundaries), head.shape.rows);
  const auto index = head.section(ContainerHead::index), payload = head.section(ContainerHead::payload);
  container.encoded.index.assign(index.begin(), index.end());
  container.encoded.payload.assign(payload.begin(), payload.end());
  return container;
}

Container compress(const VisibilityMatrix& matrix, const Codec& codec, const ObjectTree* tree) {
  Container container;
  container.shape = matrix.shape();
  container.ones = matrix.ones();
  container.codec = codec.name;
  if (tree != nullptr) container.tree = *tree;
  container.encoded = codec.encode(matrix, tree);
  return container;
}

VisibilityMatrix decompress(const Container& container, const Codec& codec) {
  assert(container.codec == codec.name);
  const auto& [payload, index] = container.encoded;
  const Shape shape = claimed_shape(container.shape.rows, container.shape.columns, container.ones);
  VisibilityMatrix matrix =
      codec.open_rows != nullptr
          ? decode_rows(codec.open_rows, codec.rows_per_part, payload, index, shape, container.ones)
          : codec.decode(payload, index, shape, container.tree ? &*container.tree : nullptr);
  if (matrix.ones() != container.ones) {
    throw FormatError("the payload holds " + std::to_string(matrix.ones()) + " ones; the file states " +
                      std::to_string(container.ones));
  }
  return matrix;
}

}  // namespace vismat
