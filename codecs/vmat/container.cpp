#include "codecs/vmat/container.h"

#include <algorithm>
#include <cassert>
#include <stdexcept>

#include "codecs/entropy/bit_stream.h"
#include "codecs/vmat/parts.h"
#include "codecs/vmat/sections.h"
#include "matrix/base/checksum.h"
#include "matrix/claimed_shape.h"

namespace vismat {
namespace {

using vmat::Section;

template <typename Number>
void put(std::vector<std::byte>& out, Number value) {
  const auto* bytes = reinterpret_cast<const std::byte*>(&value);
  out.insert(out.end(), bytes, bytes + sizeof value);
}

struct Layout {
  std::size_t head = 0;  // bytes of the head, with its two checksums
  std::uint64_t body = 0;
};

// Where the checksums and the body of a file begin whose head is there; nullopt where its sizes do not add up to the file's.
std::optional<Layout> layout_of(std::span<const std::byte> file) {
  if (file.size() < vmat::fixed_head_bytes) return std::nullopt;
  const auto sections = number_at<std::uint32_t>(file, vmat::fixed_head_bytes - 4);
  const std::uint64_t head =
      vmat::fixed_head_bytes + std::uint64_t{sections} * vmat::section_entry_bytes + vmat::head_sums_bytes;
  if (head > file.size()) return std::nullopt;
  Layout layout{head, 0};
  ByteReader in(file, ".vmat");
  in.skip(vmat::fixed_head_bytes);
  for (std::uint32_t s = 0; s < sections; ++s) {
    in.skip(4);
    const auto size = in.number<std::uint64_t>();
    if (size > file.size() - layout.body) return std::nullopt;  // also where the sum would overflow
    layout.body += size;
  }
  if (head + 4 * CheckedBytes::blocks_of(layout.body) + layout.body != file.size()) return std::nullopt;
  return layout;
}

std::string text(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

bool is_known(std::uint32_t kind) {
  return (kind >= std::uint32_t(Section::facts) && kind <= std::uint32_t(Section::list_rows)) ||
         (kind >= std::uint32_t(Section::first_shared) && kind <= std::uint32_t(Section::last_shared));
}

Side side_of(const Codec& codec, const SourceMap& source, const Side& boxes) {
  return {tree_for(codec, source), boxes.row_boxes, boxes.column_boxes};
}

}  // namespace

BoxSums box_sums(const Side& side) {
  return {crc32(std::as_bytes(side.row_boxes)), crc32(std::as_bytes(side.column_boxes))};
}

void check_boxes(const Codec& codec, Shape shape, const std::optional<BoxSums>& coded_under,
                 const Side& boxes) {
  if (codec.needs.boxes != coded_under.has_value())
    throw FormatError(coded_under ? "tells of boxes, which this codec does not code under"
                                  : "does not tell the boxes that this codec codes under");
  if (!coded_under) return;
  if (boxes.row_boxes.empty() && boxes.column_boxes.empty())
    throw FormatError("was coded under the boxes of its rows and columns; they must be given");
  if (boxes.row_boxes.size() != shape.rows || boxes.column_boxes.size() != shape.columns ||
      box_sums(boxes) != *coded_under)
    throw FormatError("was coded under other boxes of rows and columns than those given");
}

std::tuple<Shape, std::uint64_t, std::string> read_head_fields(ByteReader& head) {
  const auto rows = head.number<std::uint32_t>(), columns = head.number<std::uint32_t>();
  const auto ones = head.number<std::uint64_t>();
  if (ones > std::uint64_t{rows} * columns) head.fail("more ones than the matrix has places");
  std::string codec = text(head.bytes(vmat::name_bytes));
  const std::size_t name_end = std::min(codec.find('\0'), codec.size());
  if (codec.find_first_not_of('\0', name_end) != std::string::npos)
    head.fail("bytes behind the codec's name");
  codec.resize(name_end);
  return {Shape{rows, columns}, ones, std::move(codec)};
}

ContainerHead::ContainerHead(std::span<const std::byte> file) {
  ByteReader in(file, ".vmat");
  if (!vmat::begins_vmat(file)) in.fail("not a .vmat file: the magic number differs");
  in.skip(vmat::magic.size());
  if (const auto found = in.number<std::uint32_t>(); found != vmat::version) {
    in.fail("version " + std::to_string(found) + "; this program reads version " +
            std::to_string(vmat::version) +
            (found == 3 ? ": 'vismat decode' reads version 3, then encode again" : ""));
  }
  const auto layout = layout_of(file);
  if (!layout)
    in.fail("the file has " + std::to_string(file.size()) +
            " bytes, not what its head tells: cut short or damaged");
  if (crc32(file.first(layout->head - 4)) != number_at<std::uint32_t>(file, layout->head - 4))
    in.fail("the head's checksum differs: the file is damaged");

  std::tie(shape, ones, codec) = read_head_fields(in);
  body_ = file.last(layout->body);
  sums_ = file.subspan(layout->head, file.size() - layout->body - layout->head);
  std::uint64_t at = 0;
  std::uint32_t last = 0;
  for (auto left = in.number<std::uint32_t>(); left > 0; --left) {
    const auto kind = in.number<std::uint32_t>();
    const auto size = in.number<std::uint64_t>();
    if (kind <= last || !is_known(kind))
      in.fail("section " + std::to_string(kind) + " is unknown or out of order");
    if (size == 0) in.fail("section " + std::to_string(kind) + " is empty");
    last = kind;
    sections_.emplace_back(Section(kind), body_.subspan(at, size));
    at += size;
  }
  if (crc32(sums_) != in.number<std::uint32_t>())
    in.fail("the checksum of checksums differs: the file is damaged");
}

std::span<const std::byte> ContainerHead::section(Section which) const {
  for (const auto& [kind, bytes] : sections_) {
    if (kind == which) return bytes;
  }
  return {};
}

void seal_container(std::span<std::byte> file) {
  if (const auto layout = layout_of(file)) seal(file, layout->head, layout->body);
}

std::vector<std::byte> write_container(const Container& container) {
  assert(container.codec.size() <= vmat::name_bytes);
  const Encoded& encoded = container.encoded;
  const SourceMap& source = container.source;
  check_source_map(source, container.shape);
  if (encoded.shared.size() > std::size_t(Section::last_shared) - std::size_t(Section::first_shared) + 1)
    throw std::invalid_argument(std::to_string(encoded.shared.size()) +
                                " shared sections are more than a file holds");
  std::vector<std::pair<Section, std::vector<std::byte>>> sections;
  const auto add = [&](Section kind, std::vector<std::byte> bytes) {
    if (!bytes.empty()) sections.emplace_back(kind, std::move(bytes));
  };
  const auto facts = std::as_bytes(std::span(container.facts));
  add(Section::facts, {facts.begin(), facts.end()});
  if (source.tree) add(Section::tree, tree_bytes(*source.tree, source.columns_are_nodes));
  if (source.row_tree) add(Section::row_tree, tree_bytes(*source.row_tree, false));
  const bool shared =
      source.row_order && source.row_order == source.column_order && source.row_order->size() > 0;
  if (shared) {
    add(Section::shared_order, order_bytes(*source.row_order));
  } else {
    if (source.row_order) add(Section::row_order, order_bytes(*source.row_order));
    if (source.column_order) add(Section::column_order, order_bytes(*source.column_order));
  }
  if (source.row_groups) add(Section::row_groups, group_bytes(*source.row_groups));
  if (source.column_groups) add(Section::column_groups, group_bytes(*source.column_groups));
  add(Section::boundaries, boundary_bytes(source.boundaries));
  add(Section::row_names, name_bytes(source.row_names));
  add(Section::column_names, name_bytes(source.column_names));
  add(Section::column_levels, level_bytes(source.column_levels));
  if (container.boxes) {
    std::vector<std::byte> sums;
    put(sums, container.boxes->rows);
    put(sums, container.boxes->columns);
    add(Section::boxes, std::move(sums));
  }
  add(Section::bands, band_bytes(encoded.bands, container.shape.rows));
  add(Section::index, encoded.index);
  add(Section::payload, encoded.payload);
  if (source.list_rows) add(Section::list_rows, group_bytes(*source.list_rows));
  for (std::size_t i = 0; i < encoded.shared.size(); ++i) {
    if (encoded.shared[i].empty())
      throw std::invalid_argument("shared section " + std::to_string(i) + " is empty");
    add(Section(std::uint32_t(Section::first_shared) + i), encoded.shared[i]);
  }

  std::vector<std::byte> out;
  for (const unsigned char c : vmat::magic) out.push_back(static_cast<std::byte>(c));
  put(out, vmat::version);
  put(out, container.shape.rows);
  put(out, container.shape.columns);
  put(out, container.ones);
  for (std::size_t i = 0; i < vmat::name_bytes; ++i)
    put(out, i < container.codec.size() ? container.codec[i] : '\0');
  put(out, static_cast<std::uint32_t>(sections.size()));
  std::uint64_t body = 0;
  for (const auto& [kind, bytes] : sections) {
    put(out, static_cast<std::uint32_t>(kind));
    put(out, std::uint64_t{bytes.size()});
    body += bytes.size();
  }
  out.resize(out.size() + vmat::head_sums_bytes + 4 * CheckedBytes::blocks_of(body));
  out.reserve(out.size() + body);
  for (const auto& [kind, bytes] : sections) out.insert(out.end(), bytes.begin(), bytes.end());
  seal_container(out);
  return out;
}

std::string read_facts(const ContainerHead& head, const CheckedBytes& body) {
  return text(body.checked(head.section(Section::facts)));
}

SourceMap read_source_map(const ContainerHead& head, const CheckedBytes& body) {
  const auto section = [&](Section kind) { return body.checked(head.section(kind)); };
  SourceMap map;
  if (const auto bytes = section(Section::tree); !bytes.empty())
    std::tie(map.tree, map.columns_are_nodes) = tree_from_bytes(bytes);
  if (const auto bytes = section(Section::row_tree); !bytes.empty()) {
    auto [tree, nodes] = tree_from_bytes(bytes);
    if (nodes) throw FormatError("row tree section: rows that are a tree's nodes");
    map.row_tree = std::move(tree);
  }
  map.list_rows = groups_from_bytes(section(Section::list_rows), head.shape.rows);
  map.boundaries = boundaries_from_bytes(section(Section::boundaries), map.lists_of(head.shape));
  const auto [rows, columns] = Shape{map.rows_of(head.shape), head.shape.columns};
  map.row_order = order_from_bytes(section(Section::row_order), rows);
  map.column_order = order_from_bytes(section(Section::column_order), columns);
  if (map.row_order && map.row_order == map.column_order && rows > 0)
    throw FormatError("the same order twice; it stands once for both sides");
  if (const auto bytes = section(Section::shared_order); !bytes.empty()) {
    if (map.row_order || map.column_order || rows != columns)
      throw FormatError("an order of both sides beside one of a side, or of a matrix that is not square");
    map.row_order = map.column_order = order_from_bytes(bytes, columns);
  }
  map.row_groups = groups_from_bytes(section(Section::row_groups), rows);
  map.column_groups = groups_from_bytes(section(Section::column_groups), columns);
  map.row_names = names_from_bytes(section(Section::row_names));
  map.column_names = names_from_bytes(section(Section::column_names));
  map.column_levels = levels_from_bytes(section(Section::column_levels));
  try {
    check_source_map(map, head.shape);
  } catch (const std::invalid_argument& error) {
    throw FormatError(error.what());
  }
  return map;
}

std::optional<BoxSums> read_box_sums(const ContainerHead& head, const CheckedBytes& body) {
  const auto bytes = body.checked(head.section(Section::boxes));
  if (bytes.empty()) return std::nullopt;
  if (bytes.size() != 8)
    throw FormatError("the checksums of boxes take 8 bytes, not " + std::to_string(bytes.size()));
  return BoxSums{number_at<std::uint32_t>(bytes, 0), number_at<std::uint32_t>(bytes, 4)};
}

std::vector<std::uint32_t> read_bands(const ContainerHead& head, const CheckedBytes& body) {
  return bands_from_bytes(body.checked(head.section(Section::bands)), head.shape.rows);
}

std::vector<std::span<const std::byte>> shared_sections(const ContainerHead& head) {
  std::vector<std::span<const std::byte>> shared;
  for (auto kind = std::uint32_t(Section::first_shared); kind <= std::uint32_t(Section::last_shared);
       ++kind) {
    const auto bytes = head.section(Section(kind));
    if (bytes.empty()) continue;
    if (kind != std::uint32_t(Section::first_shared) + shared.size())
      throw FormatError("shared section " + std::to_string(shared.size()) + " is missing before another");
    shared.push_back(bytes);
  }
  return shared;
}

Container read_container(std::span<const std::byte> bytes) {
  const ContainerHead head(bytes);
  const CheckedBytes body(head.body(), head.sums());
  body.checked(head.body());
  Container container;
  container.shape = head.shape;
  container.ones = head.ones;
  container.codec = head.codec;
  container.facts = read_facts(head, body);
  container.source = read_source_map(head, body);
  container.boxes = read_box_sums(head, body);
  Encoded& encoded = container.encoded;
  encoded.bands = read_bands(head, body);
  const auto copy = [](std::span<const std::byte> from) {
    return std::vector<std::byte>(from.begin(), from.end());
  };
  encoded.index = copy(head.section(Section::index));
  encoded.payload = copy(head.section(Section::payload));
  for (const auto shared : shared_sections(head)) encoded.shared.push_back(copy(shared));
  return container;
}

Container compress(const VisibilityMatrix& matrix, const Codec& codec, SourceMap source,
                   const EncodeOptions& options, const Side& boxes) {
  if (codec.needs.boxes &&
      (boxes.row_boxes.size() != matrix.shape().rows || boxes.column_boxes.size() != matrix.shape().columns))
    throw std::invalid_argument("this codec codes under the boxes of all rows and columns");
  Container container;
  container.shape = matrix.shape();
  container.ones = matrix.ones();
  container.codec = codec.name;
  container.source = std::move(source);
  container.encoded = codec.encode(matrix, side_of(codec, container.source, boxes), options);
  if (auto& order = container.encoded.row_order) {
    container.source =
        reordered(std::move(container.source), *order, Permutation::identity(matrix.shape().columns));
    order.reset();
  }
  if (codec.needs.boxes) container.boxes = box_sums(boxes);
  return container;
}

VisibilityMatrix decompress(const Container& container, const Codec& codec, const Side& boxes) {
  assert(container.codec == codec.name);
  check_boxes(codec, container.shape, container.boxes, boxes);
  const Shape shape = claimed_shape(container.shape.rows, container.shape.columns, container.ones);
  VisibilityMatrix matrix =
      decode(codec, container.encoded, shape, side_of(codec, container.source, boxes), container.ones);
  if (matrix.ones() != container.ones) {
    throw FormatError("the payload holds " + std::to_string(matrix.ones()) + " ones; the file states " +
                      std::to_string(container.ones));
  }
  return matrix;
}

}  // namespace vismat
