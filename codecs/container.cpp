#include "codecs/container.h"

#include <algorithm>
#include <cassert>
#include <cstring>
#include <stdexcept>
#include <utility>

#include "codecs/bit_stream.h"
#include "matrix/checksum.h"
#include "codecs/row_codec.h"
#include "codecs/sections.h"
#include "matrix/claimed_shape.h"

namespace vismat {
namespace {

constexpr std::array<unsigned char, 8> magic = {0x89, 'V', 'M', 'A', 'T', '\r', '\n', 0x1a};
constexpr std::uint32_t version = 3;
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

}  // namespace

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
  const std::vector<std::byte> tree = tree_bytes(container.tree), row_tree = tree_bytes(container.row_tree),
                               row_order = order_bytes(container.row_order),
                               column_order = order_bytes(container.column_order),
                               row_groups = group_bytes(container.row_groups),
                               column_groups = group_bytes(container.column_groups),
                               boundaries = boundary_bytes(container.boundaries);
  const std::array<std::span<const std::byte>, ContainerHead::sections> sections = {
      std::as_bytes(std::span(container.facts)),
      tree,
      row_tree,
      row_order,
      column_order,
      row_groups,
      column_groups,
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
  const auto [rows, columns] = head.shape;
  container.tree = tree_from_bytes(head.section(ContainerHead::tree));
  container.row_tree = tree_from_bytes(head.section(ContainerHead::row_tree));
  container.row_order = order_from_bytes(head.section(ContainerHead::row_order), rows);
  container.column_order = order_from_bytes(head.section(ContainerHead::column_order), columns);
  container.row_groups = groups_from_bytes(head.section(ContainerHead::row_groups), rows);
  container.column_groups = groups_from_bytes(head.section(ContainerHead::column_groups), columns);
  if ((container.row_groups && container.row_order) || (container.column_groups && container.column_order))
    throw FormatError("an order beside groups; these tell it too");
  container.boundaries = boundaries_from_bytes(head.section(ContainerHead::boundaries), rows);
  const auto index = head.section(ContainerHead::index), payload = head.section(ContainerHead::payload);
  container.encoded.index.assign(index.begin(), index.end());
  container.encoded.payload.assign(payload.begin(), payload.end());
  return container;
}

Container container_of(const VisibilityMatrix& matrix, const Codec& codec, Encoded encoded) {
  Container container;
  container.shape = matrix.shape();
  container.ones = matrix.ones();
  container.codec = codec.name;
  container.encoded = std::move(encoded);
  return container;
}

Container compress(const VisibilityMatrix& matrix, const Codec& codec, const ObjectTree* tree) {
  Container container = container_of(matrix, codec, codec.encode(matrix, tree));
  if (tree != nullptr) (codec.over_tree == TreeOver::rows ? container.row_tree : container.tree) = *tree;
  return container;
}

VisibilityMatrix decompress(const Container& container, const Codec& codec) {
  assert(container.codec == codec.name);
  const auto& [payload, index] = container.encoded;
  const Shape shape = claimed_shape(container.shape.rows, container.shape.columns, container.ones);
  VisibilityMatrix matrix =
      codec.open_rows != nullptr
          ? decode_rows(codec.open_rows, codec.rows_per_part, payload, index, shape, container.ones)
          : codec.decode(payload, index, shape, tree_for(codec, container));
  if (matrix.ones() != container.ones) {
    throw FormatError("the payload holds " + std::to_string(matrix.ones()) + " ones; the file states " +
                      std::to_string(container.ones));
  }
  return matrix;
}

}  // namespace vismat
