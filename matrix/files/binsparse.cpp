// Idea: every format of the specification lists entries line by line, a line being a row or, in CSC, DCSC,
// COOC and DMATC, a column. So each is first brought to line offsets and ids, checked, rid of zeros, and made
// a matrix whose rows are the lines; column formats are then transposed and one-triangle structures joined
// with their transpose.
#include "matrix/files/binsparse.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "matrix/base/byte_reader.h"
#include "matrix/claimed_shape.h"

namespace vismat {
namespace {

using nlohmann::json;

[[noreturn]] void fail(const std::string& where, const std::string& what) {
  throw FormatError(where + ": " + what);
}

constexpr const char* descriptor_name = "attribute binsparse";

struct Descriptor {
  std::string format;
  std::uint64_t rows = 0, columns = 0, stored = 0;
  bool iso = false, complex = false, fill = false;
  std::string structure;
};

const json& member(const json& object, const char* key) {
  const auto found = object.find(key);
  if (found == object.end()) fail(descriptor_name, std::string("has no key '") + key + "'");
  return *found;
}

std::uint64_t count(const json& value, const char* what) {
  if (!value.is_number_integer() || (!value.is_number_unsigned() && value.get<std::int64_t>() < 0)) {
    fail(descriptor_name, std::string(what) + " must hold non-negative integers");
  }
  return value.get<std::uint64_t>();
}

std::string text(const json& value, const char* what) {
  if (!value.is_string()) fail(descriptor_name, std::string(what) + " must be a string");
  return value.get<std::string>();
}

Descriptor parse_descriptor(const std::string& source) {
  json whole = json::parse(source, nullptr, false);
  if (whole.is_discarded() || !whole.is_object()) fail(descriptor_name, "is not a JSON object");
  const json& binsparse = whole.contains("binsparse") ? whole["binsparse"] : whole;
  if (!binsparse.is_object()) fail(descriptor_name, "its 'binsparse' is not a JSON object");

  if (binsparse.contains("version")) {
    const std::string version = text(binsparse["version"], "version");
    if (!version.starts_with("0.") && !version.starts_with("1.")) {
      fail(descriptor_name, "version is " + json(version).dump() + "; 0.x and 1.x are read");
    }
  }
  if (binsparse.contains("custom"))
    fail(descriptor_name, "custom formats are not read, only the predefined ones");
  Descriptor descriptor;
  descriptor.format = text(member(binsparse, "format"), "format");
  const json& shape = member(binsparse, "shape");
  if (!shape.is_array() || shape.size() != 2) fail(descriptor_name, "shape must be [rows, columns]");
  descriptor.rows = count(shape[0], "shape");
  descriptor.columns = count(shape[1], "shape");
  descriptor.stored = count(member(binsparse, "number_of_stored_values"), "number_of_stored_values");

  const json& types = member(binsparse, "data_types");
  if (!types.is_object()) fail(descriptor_name, "data_types must be a JSON object");
  std::string type = text(member(types, "values"), "data_types.values");
  const auto strip = [&](const std::string& modifier) {
    if (!type.starts_with(modifier + "[") || !type.ends_with("]")) return false;
    type = type.substr(modifier.size() + 1, type.size() - modifier.size() - 2);
    return true;
  };
  descriptor.iso = strip("iso");
  descriptor.complex = strip("complex");
  constexpr const char* known[] = {"uint8", "uint16", "uint32",  "uint64",  "int8", "int16",
                                   "int32", "int64",  "float32", "float64", "bint8"};
  if (std::find(std::begin(known), std::end(known), type) == std::end(known)) {
    fail(descriptor_name, "data_types.values is of unknown type " + json(type).dump(-1, ' ', true));
  }
  if (binsparse.contains("fill")) {
    if (!binsparse["fill"].is_boolean()) fail(descriptor_name, "fill must be true or false");
    descriptor.fill = binsparse["fill"].get<bool>();
  }
  if (binsparse.contains("structure")) descriptor.structure = text(binsparse["structure"], "structure");
  return descriptor;
}

void need_length(const std::string& name, std::uint64_t length, std::uint64_t wanted, const char* why) {
  if (length != wanted) {
    fail(name,
         "has " + std::to_string(length) + " entries, but " + why + " calls for " + std::to_string(wanted));
  }
}

std::string entry(std::uint64_t i, std::uint64_t value) {
  return "entry " + std::to_string(i) + " is " + std::to_string(value);
}

// The line numbers of COO (one an entry) or of DCSR (one a non-empty line).
void check_lines(const std::vector<std::uint32_t>& lines, std::uint32_t line_count, bool may_repeat) {
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (lines[i] >= line_count) {
      fail("/indices_0", entry(i, lines[i]) + ", but there are only " + std::to_string(line_count));
    }
    if (i > 0 && (may_repeat ? lines[i] < lines[i - 1] : lines[i] <= lines[i - 1])) {
      fail("/indices_0",
           entry(i, lines[i]) + " after " + std::to_string(lines[i - 1]) + "; they must ascend");
    }
  }
}

void check_offsets(const std::vector<std::uint64_t>& offsets, std::uint64_t ids, const std::string& name) {
  if (offsets.front() != 0) fail(name, "begins with " + std::to_string(offsets.front()) + " instead of 0");
  for (std::size_t i = 1; i < offsets.size(); ++i) {
    if (offsets[i] < offsets[i - 1]) fail(name, "descends at entry " + std::to_string(i));
  }
  if (offsets.back() != ids) {
    fail(name, "ends with " + std::to_string(offsets.back()) + ", but there are " + std::to_string(ids) +
                   " entries");
  }
}

void check_ids(const std::vector<std::uint64_t>& offsets, const std::vector<std::uint32_t>& ids,
               std::uint32_t bound, const std::string& name, const std::string& line_is,
               const std::string& id_is) {
  for (std::size_t line = 0; line + 1 < offsets.size(); ++line) {
    for (std::uint64_t i = offsets[line]; i < offsets[line + 1]; ++i) {
      if (ids[i] >= bound) {
        fail(name, entry(i, ids[i]) + ", but there are " + std::to_string(bound) + " " + id_is + "s");
      }
      if (i > offsets[line] && ids[i] <= ids[i - 1]) {
        fail(name, entry(i, ids[i]) + " after " + std::to_string(ids[i - 1]) + " in the same " + line_is +
                       " (" + std::to_string(line) + "); there they must ascend");
      }
    }
  }
}

VisibilityMatrix read_dense(const Hdf5File& file, const Descriptor& descriptor, Shape lines) {
  const std::uint64_t cells = std::uint64_t{lines.rows} * lines.columns;
  need_length("/values", descriptor.stored, cells, "the shape");
  const std::vector<std::uint8_t> truth = file.read_truth("/values");
  const std::uint64_t step = descriptor.complex ? 2 : 1;
  need_length("/values", truth.size(), descriptor.iso ? step : cells * step, "the shape");
  std::vector<std::uint64_t> offsets = {0};
  std::vector<std::uint32_t> ids;
  for (std::uint32_t line = 0; line < lines.rows; ++line) {
    for (std::uint32_t id = 0; id < lines.columns; ++id) {
      const std::uint64_t at = descriptor.iso ? 0 : (std::uint64_t{line} * lines.columns + id) * step;
      if (truth[at] || truth[at + step - 1]) ids.push_back(id);
    }
    offsets.push_back(ids.size());
  }
  return VisibilityMatrix::from_csr(lines, std::move(offsets), std::move(ids));
}

// An entry whose value is zero is none.
void drop_zeros(const Hdf5File& file, const Descriptor& descriptor, std::vector<std::uint64_t>& offsets,
                std::vector<std::uint32_t>& ids) {
  const std::uint64_t step = descriptor.complex ? 2 : 1;
  const std::vector<std::uint8_t> truth = file.read_truth("/values");
  if (descriptor.iso) {
    if (truth.size() != step && !ids.empty()) need_length("/values", truth.size(), step, "an iso type");
    if (std::count(truth.begin(), truth.end(), 1) > 0) return;
    ids.clear();
    offsets.assign(offsets.size(), 0);
    return;
  }
  need_length("/values", truth.size(), descriptor.stored * step, "number_of_stored_values");
  std::uint64_t kept = 0, from = 0;
  for (std::size_t line = 0; line + 1 < offsets.size(); ++line) {
    for (; from < offsets[line + 1]; ++from) {
      if (truth[from * step] || truth[from * step + step - 1]) ids[kept++] = ids[from];
    }
    offsets[line + 1] = kept;
  }
  ids.resize(kept);
}

// The union with the other triangle, which the structure implies.
VisibilityMatrix both_triangles(const VisibilityMatrix& half, const std::string& structure) {
  constexpr const char* known[] = {"symmetric_lower", "symmetric_upper",      "hermitian_lower",
                                   "hermitian_upper", "skew_symmetric_lower", "skew_symmetric_upper"};
  if (std::find(std::begin(known), std::end(known), structure) == std::end(known)) {
    fail(descriptor_name,
         "structure " + json(structure).dump(-1, ' ', true) + " is not one of the specification's");
  }
  const Shape shape = half.shape();
  if (shape.rows != shape.columns) fail(descriptor_name, "structure " + structure + " needs a square matrix");
  const bool lower = structure.ends_with("lower");
  const VisibilityMatrix other = transpose(half);
  std::vector<std::uint64_t> offsets = {0};
  offsets.reserve(std::size_t{shape.rows} + 1);
  std::vector<std::uint32_t> ids;
  ids.reserve(half.ones() * 2);
  for (std::uint32_t r = 0; r < shape.rows; ++r) {
    const auto stored = half.row(r), implied = other.row(r);
    if (!stored.empty() && (lower ? stored.back() > r : stored.front() < r)) {
      fail(descriptor_name, "structure is " + structure + ", but row " + std::to_string(r) +
                                " has entries in the other triangle");
    }
    std::set_union(stored.begin(), stored.end(), implied.begin(), implied.end(), std::back_inserter(ids));
    offsets.push_back(ids.size());
  }
  return VisibilityMatrix::from_csr(shape, std::move(offsets), std::move(ids));
}

struct Lines {
  std::vector<std::uint64_t> offsets;
  std::vector<std::uint32_t> ids;
};

// The compressed and the coordinate formats, as line offsets and ids.
Lines read_lines(const Hdf5File& file, const Descriptor& descriptor, std::uint32_t line_count,
                 bool coordinates, bool packed) {
  Lines lines;
  std::vector<std::uint32_t> named;  // lines
  if (coordinates || packed) {
    named = file.read<std::uint32_t>("/indices_0");
    if (coordinates) need_length("/indices_0", named.size(), descriptor.stored, "number_of_stored_values");
    check_lines(named, line_count, coordinates);
  }
  if (!coordinates) {
    lines.offsets = file.read<std::uint64_t>("/pointers_to_1");
    need_length("/pointers_to_1", lines.offsets.size(),
                (packed ? named.size() : line_count) + std::uint64_t{1}, packed ? "/indices_0" : "the shape");
    check_offsets(lines.offsets, descriptor.stored, "/pointers_to_1");
  }
  if (coordinates || packed) {
    std::vector<std::uint64_t> spread(std::size_t{line_count} + 1, 0);
    for (std::size_t i = 0; i < named.size(); ++i) {
      spread[named[i] + std::size_t{1}] += coordinates ? 1 : lines.offsets[i + 1] - lines.offsets[i];
    }
    for (std::size_t line = 0; line < line_count; ++line) spread[line + 1] += spread[line];
    lines.offsets = std::move(spread);
  }
  named = {};
  lines.ids = file.read<std::uint32_t>("/indices_1");
  need_length("/indices_1", lines.ids.size(), descriptor.stored, "number_of_stored_values");
  return lines;
}

VisibilityMatrix read_matrix(const Hdf5File& file, const Descriptor& descriptor) {
  const std::string& format = descriptor.format;
  const bool dense = format == "DMAT" || format == "DMATR" || format == "DMATC";
  const bool coordinates = format == "COO" || format == "COOR" || format == "COOC";
  const bool packed = format == "DCSR" || format == "DCSC";
  if (!dense && !coordinates && !packed && format != "CSR" && format != "CSC") {
    const bool vector = format.ends_with("VEC");
    fail(descriptor_name, "format " + json(format).dump(-1, ' ', true) +
                              (vector ? " is a vector" : " is not known") +
                              "; need CSR, CSC, DCSR, DCSC, COO, COOR, COOC, DMAT, DMATR or DMATC");
  }
  if (descriptor.fill) {
    const auto truth = file.read_truth("/fill_value");
    if (std::count(truth.begin(), truth.end(), 1) > 0) {
      fail("/fill_value", "is not zero, so that entries which are not listed would be visible");
    }
  }
  const bool by_columns = format.ends_with("C");
  const std::string line_is = by_columns ? "column" : "row", id_is = by_columns ? "row" : "column";
  const Shape shape = claimed_shape(descriptor.rows, descriptor.columns, descriptor.stored);
  const Shape lines = by_columns ? Shape{shape.columns, shape.rows} : shape;
  VisibilityMatrix matrix;
  if (dense) {
    matrix = read_dense(file, descriptor, lines);
  } else {
    auto [offsets, ids] = read_lines(file, descriptor, lines.rows, coordinates, packed);
    check_ids(offsets, ids, lines.columns, "/indices_1", line_is, id_is);
    drop_zeros(file, descriptor, offsets, ids);
    matrix = VisibilityMatrix::from_csr(lines, std::move(offsets), std::move(ids));
  }
  if (by_columns) matrix = transpose(matrix);
  return descriptor.structure.empty() ? std::move(matrix) : both_triangles(matrix, descriptor.structure);
}

// -- what the specification does not know: our own facts and geometry
// ---------------------------------------------

std::vector<Box> read_boxes(const Hdf5File& file, const std::string& name, std::uint32_t boxes) {
  if (!file.contains(name)) return {};
  const auto dimensions = file.dimensions(name);
  if (dimensions != std::vector<std::uint64_t>{boxes, 6}) {
    fail(name,
         "must have dimensions [" + std::to_string(boxes) + ", 6]: low x, y, z and high x, y, z of each");
  }
  const std::vector<float> numbers = file.read<float>(name);
  std::vector<Box> bounds(boxes);
  for (std::size_t b = 0; b < boxes; ++b) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const float low = numbers[b * 6 + axis], high = numbers[b * 6 + 3 + axis];
      if (!std::isfinite(low) || !std::isfinite(high) || low > high) {
        fail(name, "box " + std::to_string(b) + " is not finite or its low corner not below its high one");
      }
      bounds[b].low[axis] = low;
      bounds[b].high[axis] = high;
    }
  }
  return bounds;
}

void write_boxes(Hdf5File& file, const std::string& name, const std::vector<Box>& bounds) {
  if (bounds.empty()) return;
  std::vector<float> numbers;
  numbers.reserve(bounds.size() * 6);
  for (const Box& box : bounds) {
    numbers.insert(numbers.end(), box.low.begin(), box.low.end());
    numbers.insert(numbers.end(), box.high.begin(), box.high.end());
  }
  file.write<float>(name, numbers, {bounds.size(), 6});
}

std::optional<Permutation> read_order(const Hdf5File& file, const std::string& name, std::uint32_t size) {
  if (!file.contains(name)) return std::nullopt;
  auto map = file.read<std::uint32_t>(name);
  need_length(name, map.size(), size, "the number of rows or columns");
  try {
    return Permutation::from_new_of_old(std::move(map));
  } catch (const std::invalid_argument& error) {
    fail(name, error.what());
  }
}

std::optional<Partition> read_groups(const Hdf5File& file, const std::string& name, std::uint32_t groups,
                                     const std::string& order) {
  if (!file.contains(name)) return std::nullopt;
  if (file.contains(order)) fail(name, "stands beside " + order + "; the groups tell the order too");
  try {
    auto partition = Partition::from_group_of_member(file.read<std::uint32_t>(name));
    if (partition.groups() != groups) {
      fail(name, "has " + std::to_string(partition.groups()) + " groups, but there are " +
                     std::to_string(groups) + " rows or columns");
    }
    return partition;
  } catch (const std::invalid_argument& error) {
    fail(name, error.what());
  }
}

void write_groups(Hdf5File& file, const std::string& name, const std::optional<Partition>& groups) {
  if (groups) file.write(name, groups->group_of_member(), {groups->size()});
}

void write_order(Hdf5File& file, const std::string& name, const std::optional<Permutation>& order) {
  if (order) file.write(name, order->new_of_old(), {order->size()});
}

const std::string neighbours_group = "/vismat/row_neighbours", tree_group = "/vismat/tree",
                  row_tree_group = "/vismat/row_tree";

std::optional<VisibilityMatrix> read_neighbours(const Hdf5File& file, std::uint32_t rows) {
  if (!file.contains(neighbours_group)) return std::nullopt;
  auto offsets = file.read<std::uint64_t>(neighbours_group + "/pointers_to_1");
  auto ids = file.read<std::uint32_t>(neighbours_group + "/indices_1");
  need_length(neighbours_group + "/pointers_to_1", offsets.size(), std::uint64_t{rows} + 1,
              "the number of rows");
  check_offsets(offsets, ids.size(), neighbours_group + "/pointers_to_1");
  check_ids(offsets, ids, rows, neighbours_group + "/indices_1", "row", "row");
  return VisibilityMatrix::from_csr({rows, rows}, std::move(offsets), std::move(ids));
}

std::vector<Boundary> read_boundaries(const Hdf5File& file, std::uint32_t rows) {
  const std::string name = "/vismat/boundaries";
  if (!file.contains(name)) return {};
  const auto dimensions = file.dimensions(name);
  if (rows % 2 != 0 || dimensions != std::vector<std::uint64_t>{rows / 2, 2}) {
    fail(name, "must have dimensions [rows / 2, 2], but there are " + std::to_string(rows) + " rows");
  }
  const std::vector<std::uint32_t> cells = file.read<std::uint32_t>(name);
  std::vector<Boundary> boundaries(rows / 2);
  for (std::size_t b = 0; b < boundaries.size(); ++b) boundaries[b] = {cells[2 * b], cells[2 * b + 1]};
  try {
    BoundaryMap map(boundaries);
  } catch (const std::invalid_argument& error) {
    fail(name, error.what());
  }
  return boundaries;
}

void write_boundaries(Hdf5File& file, const std::vector<Boundary>& boundaries) {
  if (boundaries.empty()) return;
  std::vector<std::uint32_t> cells;
  cells.reserve(boundaries.size() * 2);
  for (const auto [from, to] : boundaries) cells.insert(cells.end(), {from, to});
  file.write<std::uint32_t>("/vismat/boundaries", cells, {boundaries.size(), 2});
}

/// `width` finite numbers an entry of the matrix; empty where the file has none.
std::vector<float> read_of_entries(const Hdf5File& file, const std::string& name, std::uint64_t ones,
                                   std::uint64_t width) {
  if (!file.contains(name)) return {};
  const auto dimensions = file.dimensions(name);
  if (dimensions != (width == 1 ? std::vector{ones} : std::vector{ones, width})) {
    fail(name, "must have a line of " + std::to_string(width) + " for each of the " + std::to_string(ones) +
                   " entries");
  }
  std::vector<float> numbers = file.read<float>(name);
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    if (!std::isfinite(numbers[i]))
      fail(name, "entry " + std::to_string(i / width) + " is not a finite number");
  }
  return numbers;
}

std::optional<ObjectTree> read_tree(const Hdf5File& file, const std::string& group) {
  if (!file.contains(group)) return std::nullopt;
  const auto objects = file.number_attribute(group, "object_count");
  if (!objects || *objects >= ObjectTree::none) fail(group, "needs an attribute object_count below 2^32 - 1");
  try {
    return ObjectTree::from_parents(file.read<std::uint32_t>(group + "/parent"),
                                    file.read<std::uint32_t>(group + "/object"),
                                    static_cast<std::uint32_t>(*objects));
  } catch (const std::invalid_argument& error) {
    fail(group, error.what());
  }
}

void write_tree(Hdf5File& file, const std::string& group, const std::optional<ObjectTree>& tree) {
  if (!tree) return;
  file.write(group + "/parent", tree->parent_of_node(), {tree->size()});
  file.write(group + "/object", tree->object_of_node(), {tree->size()});
  file.write_attribute(group, "object_count", tree->object_count());
}

constexpr const char* row_names_array = "/vismat/row_names";
constexpr const char* column_names_array = "/vismat/column_names";
constexpr const char* column_levels_array = "/vismat/column_levels";

std::vector<std::string> read_names(const Hdf5File& file, const std::string& name) {
  if (!file.contains(name)) return {};
  const std::vector<std::uint8_t> bytes = file.read<std::uint8_t>(name);
  if (bytes.empty() || bytes.back() != 0) fail(name, "must be names with a zero byte behind each");
  std::vector<std::string> names;
  for (auto at = bytes.begin(); at != bytes.end();) {
    const auto end = std::find(at, bytes.end(), std::uint8_t{0});
    names.emplace_back(at, end);
    at = end + 1;
  }
  return names;
}

void write_names(Hdf5File& file, const std::string& name, const std::vector<std::string>& names) {
  if (names.empty()) return;
  std::vector<std::uint8_t> bytes;
  for (const std::string& n : names) {
    bytes.insert(bytes.end(), n.begin(), n.end());
    bytes.push_back(0);
  }
  file.write<std::uint8_t>(name, bytes, {bytes.size()});
}

std::vector<ObjectLevel> read_levels(const Hdf5File& file) {
  const std::string name = column_levels_array;
  if (!file.contains(name)) return {};
  const auto dimensions = file.dimensions(name);
  if (dimensions.size() != 2 || dimensions[1] != 2)
    fail(name, "must have dimensions [columns of the source, 2]");
  const std::vector<std::uint32_t> numbers = file.read<std::uint32_t>(name);
  std::vector<ObjectLevel> levels(numbers.size() / 2);
  for (std::size_t i = 0; i < levels.size(); ++i) levels[i] = {numbers[2 * i], numbers[2 * i + 1]};
  return levels;
}

void write_levels(Hdf5File& file, const std::vector<ObjectLevel>& levels) {
  if (levels.empty()) return;
  std::vector<std::uint32_t> numbers;
  for (const auto [object, level] : levels) numbers.insert(numbers.end(), {object, level});
  file.write<std::uint32_t>(column_levels_array, numbers, {levels.size(), 2});
}

SourceMap read_source_map(const Hdf5File& file, const VisibilityMatrix& matrix) {
  const Shape shape = matrix.shape();
  SourceMap map;
  map.columns_are_nodes = file.number_attribute("/", "vismat_columns_are_nodes").value_or(0) != 0;
  map.boundaries = read_boundaries(file, shape.rows);
  map.row_order = read_order(file, "/vismat/row_order", map.rows_of(shape));
  map.column_order = read_order(file, "/vismat/column_order", shape.columns);
  map.row_groups = read_groups(file, "/vismat/row_groups", map.rows_of(shape), "/vismat/row_order");
  map.column_groups = read_groups(file, "/vismat/column_groups", shape.columns, "/vismat/column_order");
  map.tree = read_tree(file, tree_group);
  map.row_tree = read_tree(file, row_tree_group);
  map.row_names = read_names(file, row_names_array);
  map.column_names = read_names(file, column_names_array);
  map.column_levels = read_levels(file);
  drop_tree_over_lists(map, shape);
  try {
    check_source_map(map, shape);
  } catch (const std::invalid_argument& error) {
    throw FormatError(std::string("/vismat/") + error.what());
  }
  if (map.columns_are_nodes && map.boundaries.empty() && !is_monotone(matrix, *map.tree))
    fail("/indices_1", "a row sees a node of " + tree_group + " but not its parent");
  return map;
}

}  // namespace

Dataset read_binsparse(const Hdf5File& file) {
  const auto source = file.string_attribute("/", "binsparse");
  if (!source) {
    if (file.contains("/scene"))
      throw FormatError("holds a scene, not a matrix; 'vismat see' makes one of it");
    throw FormatError("has no attribute 'binsparse' on its root group: it holds no matrix");
  }
  Dataset dataset;
  dataset.matrix = read_matrix(file, parse_descriptor(*source));
  const Shape shape = dataset.matrix.shape();
  dataset.rows_are = file.string_attribute("/", "vismat_rows_are").value_or(dataset.rows_are);
  dataset.columns_are = file.string_attribute("/", "vismat_columns_are").value_or(dataset.columns_are);
  dataset.provenance = file.string_attribute("/", "vismat_provenance").value_or("");
  if (const auto guarantee = file.string_attribute("/", "vismat_guarantee")) {
    try {
      dataset.guarantee = guarantee_from_string(*guarantee);
    } catch (const std::invalid_argument& error) {
      fail("attribute vismat_guarantee", error.what());
    }
  }
  dataset.seed = file.number_attribute("/", "vismat_seed");
  dataset.row_bounds = read_boxes(file, "/vismat/row_bounds", shape.rows);
  dataset.column_bounds = read_boxes(file, "/vismat/column_bounds", shape.columns);
  dataset.row_neighbours = read_neighbours(file, shape.rows);
  const std::vector<float> lines = read_of_entries(file, "/vismat/sight_lines", dataset.matrix.ones(), 6);
  dataset.sight_lines.resize(lines.size() / 6);
  for (std::size_t i = 0; i < lines.size(); ++i) dataset.sight_lines[i / 6][i % 6] = lines[i];
  dataset.degree_of_visibility =
      read_of_entries(file, "/vismat/degree_of_visibility", dataset.matrix.ones(), 1);
  dataset.source = read_source_map(file, dataset.matrix);
  return dataset;
}

void write_binsparse(Hdf5File& file, const Dataset& dataset) {
  const VisibilityMatrix& matrix = dataset.matrix;
  const Shape shape = matrix.shape();
  assert(dataset.row_bounds.empty() || dataset.row_bounds.size() == shape.rows);
  assert(dataset.column_bounds.empty() || dataset.column_bounds.size() == shape.columns);
  const json descriptor = {
      {"binsparse",
       {{"version", "0.1"},
        {"format", "CSR"},
        {"shape", {shape.rows, shape.columns}},
        {"number_of_stored_values", matrix.ones()},
        {"data_types", {{"pointers_to_1", "uint64"}, {"indices_1", "uint32"}, {"values", "iso[bint8]"}}}}}};
  constexpr std::uint8_t one = 1;
  file.write_attribute("/", "binsparse", descriptor.dump());
  file.write("/pointers_to_1", matrix.offsets(), {matrix.offsets().size()});
  file.write("/indices_1", matrix.ids(), {matrix.ones()});
  file.write("/values", std::span(&one, 1), {1});

  file.write_attribute("/", "vismat_rows_are", dataset.rows_are);
  file.write_attribute("/", "vismat_columns_are", dataset.columns_are);
  file.write_attribute("/", "vismat_provenance", dataset.provenance);
  file.write_attribute("/", "vismat_guarantee", std::string(to_string(dataset.guarantee)));
  if (dataset.seed) file.write_attribute("/", "vismat_seed", *dataset.seed);
  const SourceMap& map = dataset.source;
  if (map.columns_are_nodes) file.write_attribute("/", "vismat_columns_are_nodes", 1);
  write_boxes(file, "/vismat/row_bounds", dataset.row_bounds);
  write_boxes(file, "/vismat/column_bounds", dataset.column_bounds);
  write_order(file, "/vismat/row_order", map.row_order);
  write_order(file, "/vismat/column_order", map.column_order);
  write_groups(file, "/vismat/row_groups", map.row_groups);
  write_groups(file, "/vismat/column_groups", map.column_groups);
  if (dataset.row_neighbours) {
    const VisibilityMatrix& neighbours = *dataset.row_neighbours;
    file.write(neighbours_group + "/pointers_to_1", neighbours.offsets(), {neighbours.offsets().size()});
    file.write(neighbours_group + "/indices_1", neighbours.ids(), {neighbours.ones()});
  }
  if (!dataset.sight_lines.empty()) {
    assert(dataset.sight_lines.size() == matrix.ones());
    file.write("/vismat/sight_lines",
               std::span<const float>(dataset.sight_lines[0].data(), 6 * matrix.ones()), {matrix.ones(), 6});
  }
  if (!dataset.degree_of_visibility.empty()) {
    assert(dataset.degree_of_visibility.size() == matrix.ones());
    file.write<float>("/vismat/degree_of_visibility", dataset.degree_of_visibility, {matrix.ones()});
  }
  write_boundaries(file, map.boundaries);
  write_tree(file, tree_group, map.tree);
  write_tree(file, row_tree_group, map.row_tree);
  write_names(file, row_names_array, map.row_names);
  write_names(file, column_names_array, map.column_names);
  write_levels(file, map.column_levels);
}

}  // namespace vismat
