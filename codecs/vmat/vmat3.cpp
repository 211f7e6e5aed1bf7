#include "codecs/vmat/vmat3.h"

#include <algorithm>
#include <array>
#include <bit>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>

#include "codecs/entropy/bit_stream.h"
#include "codecs/entropy/elias_fano.h"
#include "codecs/vmat/part_index.h"
#include "codecs/vmat/sections.h"
#include "matrix/base/checksum.h"
#include "matrix/claimed_shape.h"

namespace vismat {
namespace {

using Bytes = std::span<const std::byte>;

enum {
  facts,
  tree,
  row_tree,
  row_order,
  column_order,
  row_groups,
  column_groups,
  boundaries,
  index,
  payload,
  sections
};
constexpr std::size_t head_bytes = 148;

struct File {
  std::array<Bytes, sections> section;
  Bytes sums, body;
};

std::optional<File> file_of(Bytes bytes) {
  if (bytes.size() < head_bytes) return std::nullopt;
  ByteReader in(bytes, ".vmat");
  in.skip(60);
  std::array<std::uint64_t, sections> sizes;
  std::uint64_t body = 0;
  for (std::uint64_t& size : sizes) {
    size = in.number<std::uint64_t>();
    if (size > bytes.size() - body) return std::nullopt;
    body += size;
  }
  const std::uint64_t blocks = CheckedBytes::blocks_of(body);
  if (head_bytes + 4 * blocks + body != bytes.size()) return std::nullopt;
  File file;
  file.sums = bytes.subspan(head_bytes, 4 * blocks);
  file.body = bytes.last(body);
  std::uint64_t at = 0;
  for (std::size_t s = 0; s < sections; ++s) {
    file.section[s] = file.body.subspan(at, sizes[s]);
    at += sizes[s];
  }
  return file;
}

unsigned place_bits(std::uint32_t size) {
  return size < 2 ? 0 : static_cast<unsigned>(std::bit_width(size - 1));
}

// What a constructor refuses comes from bad bytes here.
template <typename Make>
auto made(const char* section, const Make& make) {
  try {
    return make();
  } catch (const std::invalid_argument& error) {
    throw FormatError(std::string(section) + " section: " + error.what());
  }
}

std::optional<ObjectTree> tree_of(Bytes bytes) {
  if (bytes.empty()) return std::nullopt;
  ByteReader in(bytes, "tree section");
  const std::uint32_t objects = small_varint(in, "object count");
  const std::uint64_t size = in.varint();
  if (size > in.left()) in.fail(std::to_string(size) + " nodes in " + std::to_string(in.left()) + " bytes");
  std::vector<std::uint32_t> parents, held;
  for (std::uint32_t n = 0; n < size; ++n) {
    const std::uint32_t back = n == 0 ? 0 : small_varint(in, "step back");
    if (n > 0 && (back == 0 || back > n))
      in.fail("node " + std::to_string(n) + " has its parent " + std::to_string(back) + " back");
    parents.push_back(n == 0 ? ObjectTree::none : n - back);
  }
  for (std::uint32_t n = 0; n < size; ++n) held.push_back(small_varint(in, "object") - 1);  // 0 becomes none
  if (in.left() != 0) in.fail("bytes after the last node");
  return made("tree", [&] { return ObjectTree::from_parents(std::move(parents), std::move(held), objects); });
}

std::optional<Permutation> order_of(Bytes bytes, std::uint32_t size) {
  if (bytes.empty()) return std::nullopt;
  if (bytes.size() != (std::uint64_t{size} * place_bits(size) + 7) / 8)
    throw FormatError("an order of " + std::to_string(bytes.size()) + " bytes for " + std::to_string(size) +
                      " places");
  BitReader bits(bytes);
  std::vector<std::uint32_t> map(size);
  for (std::uint32_t& place : map) place = bits.get(place_bits(size));
  bits.finish();
  return made("order", [&] { return Permutation::from_new_of_old(std::move(map)); });
}

std::optional<Partition> groups_of(Bytes bytes, std::uint32_t groups) {
  if (bytes.empty()) return std::nullopt;
  ByteReader in(bytes, "groups section");
  const std::uint32_t members = small_varint(in, "member count");
  const bool sorted = in.number<std::uint8_t>() == 0;
  auto coded = read_coded_groups(in, members, groups);
  return made("groups", [&] {
    auto partition = Partition::from_group_of_member(std::move(coded.group_of_member));
    if (!sorted) {
      std::vector<std::uint32_t> order(groups);
      for (std::uint32_t& g : order) g = coded.rest.get(place_bits(groups));
      partition = renumbered(partition, Permutation::from_new_of_old(std::move(order)));
    }
    coded.rest.finish();
    return partition;
  });
}

// Tree codecs: a varint for each part, behind the model.
std::vector<std::uint64_t> starts_over_tree(Bytes index, std::uint64_t payload_bytes) {
  ByteReader in(index, "node index");
  std::vector<std::uint64_t> sizes;
  std::uint64_t all = 0;
  while (in.left() > 0) {
    sizes.push_back(in.varint());
    if (sizes.back() > payload_bytes - all) in.fail("more bytes than the payload has");
    all += sizes.back();
  }
  std::uint64_t at = payload_bytes - all;
  for (std::uint64_t& size : sizes) at += std::exchange(size, at);
  return sizes;
}

// Row codecs: the Elias-Fano list of the places where `parts` begin, and of the payload's end.
std::vector<std::uint64_t> starts_of_rows(Bytes index, std::uint64_t parts, std::uint64_t payload_bytes) {
  const auto damaged = [] { return FormatError("the row index is damaged"); };
  const std::uint64_t count = parts + 1;
  const unsigned low_bits = elias_fano_low_bits(count, payload_bytes);
  const std::uint64_t sample_bytes = 8 * ((count + 63) / 64),
                      high_bytes = 8 * ((count + (payload_bytes >> low_bits) + 1 + 63) / 64),
                      low_bytes = 8 * ((count * low_bits + 63) / 64);
  if (index.size() != sample_bytes + high_bytes + low_bytes) throw damaged();
  BitReader high(index.subspan(sample_bytes)), low(index.last(low_bytes));
  std::vector<std::uint64_t> starts;
  for (std::uint64_t place = 0; place < 8 * high_bytes; ++place) {
    if (high.get(1) == 0) continue;
    if (starts.size() == count) throw damaged();
    std::uint64_t number = (place - starts.size()) << low_bits;
    for (unsigned b = 0; b < low_bits; b += 16)
      number |= std::uint64_t{low.get(std::min(16u, low_bits - b))} << b;
    if (number > payload_bytes || (!starts.empty() && number < starts.back())) throw damaged();
    if (starts.size() % 64 == 0) {
      if (number_at<std::uint64_t>(index, 8 * (starts.size() / 64)) != place) throw damaged();
    }
    starts.push_back(number);
  }
  if (starts.size() != count || starts.back() != payload_bytes) throw damaged();
  starts.pop_back();
  return starts;
}

std::vector<std::byte> index_of(const Codec& codec, const File& file, Shape shape) {
  const std::uint64_t bytes = file.section[payload].size();
  if (codec.needs.tree != TreeOver::nothing)
    return part_index_bytes(starts_over_tree(file.section[index], bytes), bytes);
  if (codec.open == nullptr) {
    if (!file.section[index].empty()) throw FormatError("an index of a payload in one piece");
    return {};
  }
  const std::uint64_t parts = (std::uint64_t{shape.rows} + codec.rows_per_part - 1) / codec.rows_per_part;
  if (!file.section[index].empty())
    return part_index_bytes(starts_of_rows(file.section[index], parts, bytes), bytes);
  if (parts == 0 ? bytes != 0 : bytes % parts != 0)
    throw FormatError("no row index, and " + std::to_string(bytes) + " bytes are not " +
                      std::to_string(parts) + " equal parts");
  if (bytes == 0) claimed_shape(shape.rows, 0, 0);  // rows that no byte backs
  std::vector<std::uint64_t> starts(parts);
  for (std::uint64_t i = 0; i < parts; ++i) starts[i] = i * (bytes / parts);
  return part_index_bytes(starts, bytes);
}

}  // namespace

bool is_vmat3(Bytes file) {
  return vmat::begins_vmat(file) && file.size() >= 12 && number_at<std::uint32_t>(file, 8) == 3;
}

void seal_vmat3(std::span<std::byte> bytes) {
  if (const auto file = file_of(bytes)) seal(bytes, head_bytes, file->body.size());
}

Container read_vmat3(Bytes bytes, std::span<const Codec> codecs) {
  ByteReader in(bytes, ".vmat, version 3");
  if (!is_vmat3(bytes)) in.fail("not a .vmat file of version 3");
  const auto file = file_of(bytes);
  if (!file)
    in.fail("the file has " + std::to_string(bytes.size()) +
            " bytes, not what its head tells: cut short or damaged");
  if (crc32(bytes.first(head_bytes - 4)) != number_at<std::uint32_t>(bytes, head_bytes - 4) ||
      crc32(file->sums) != number_at<std::uint32_t>(bytes, head_bytes - 8))
    in.fail("the head's checksum differs: the file is damaged");
  CheckedBytes(file->body, file->sums).checked(file->body);
  Container container;
  in.skip(12);
  std::tie(container.shape, container.ones, container.codec) = read_head_fields(in);
  const auto [rows, columns] = container.shape;
  const Codec& codec = codec_of_file(container.codec, codecs);

  SourceMap& source = container.source;
  const Bytes said = file->section[facts];
  std::istringstream lines(std::string(reinterpret_cast<const char*>(said.data()), said.size()));
  for (std::string line; std::getline(lines, line);) {
    if (line == "columns_are_nodes: yes")
      source.columns_are_nodes = true;
    else
      container.facts += line + "\n";
  }
  source.tree = tree_of(file->section[tree]);
  source.row_tree = tree_of(file->section[row_tree]);
  source.row_order = order_of(file->section[row_order], rows);
  source.column_order = order_of(file->section[column_order], columns);
  source.row_groups = groups_of(file->section[row_groups], rows);
  source.column_groups = groups_of(file->section[column_groups], columns);
  source.boundaries = boundaries_from_bytes(file->section[boundaries], rows);
  // Tree codecs over columns take its nodes for the columns, whether the facts say so or not.
  if (codec.needs.tree == TreeOver::columns) source.columns_are_nodes = true;
  // Differences may have a tree over their lists, which no source map has: it serves to decode them.
  SourceMap checked = source;
  drop_tree_over_lists(checked, container.shape);
  made("source map", [&] {
    check_source_map(checked, container.shape);
    return 0;
  });
  container.encoded.payload.assign(file->section[payload].begin(), file->section[payload].end());
  container.encoded.index = index_of(codec, *file, container.shape);
  return container;
}

}  // namespace vismat
