// The specification covers the matrix (binsparse_matrix.h). This file adds what it does not cover: our own facts and
// geometry, which are arrays and attributes beside the matrix.
#include "matrix/files/binsparse.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <string>
#include <utility>

#include "matrix/base/byte_reader.h"
#include "matrix/files/binsparse_matrix.h"
#include "matrix/files/hdf5_names.h"

namespace vismat {
namespace {

std::vector<Box> read_boxes(const Hdf5File& file, const std::string& name, std::uint32_t boxes) {
  if (!file.contains(name)) return {};
  const auto dimensions = file.dimensions(name);
  if (dimensions != std::vector<std::uint64_t>{boxes, 6}) {
    refuse_array(name, "must have dimensions [" + std::to_string(boxes) +
                           ", 6]: low x, y, z and high x, y, z of each");
  }
  const std::vector<float> numbers = file.read<float>(name);
  std::vector<Box> bounds(boxes);
  for (std::size_t b = 0; b < boxes; ++b) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const float low = numbers[b * 6 + axis], high = numbers[b * 6 + 3 + axis];
      if (!std::isfinite(low) || !std::isfinite(high) || low > high) {
        refuse_array(name,
                     "box " + std::to_string(b) + " is not finite or its low corner not below its high one");
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
    refuse_array(name, error.what());
  }
}

std::optional<Partition> read_groups(const Hdf5File& file, const std::string& name, std::uint32_t groups,
                                     const std::string& order = {}) {
  if (!file.contains(name)) return std::nullopt;
  if (!order.empty() && file.contains(order))
    refuse_array(name, "stands beside " + order + "; the groups tell the order too");
  try {
    auto partition = Partition::from_group_of_member(file.read<std::uint32_t>(name));
    if (partition.groups() != groups) {
      refuse_array(name, "has " + std::to_string(partition.groups()) + " groups, but there are " +
                             std::to_string(groups) + " rows or columns");
    }
    return partition;
  } catch (const std::invalid_argument& error) {
    refuse_array(name, error.what());
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

std::vector<Boundary> read_boundaries(const Hdf5File& file, std::uint32_t lists) {
  const std::string name = "/vismat/boundaries";
  if (!file.contains(name)) return {};
  const auto dimensions = file.dimensions(name);
  if (lists % 2 != 0 || dimensions != std::vector<std::uint64_t>{lists / 2, 2}) {
    refuse_array(name,
                 "must have dimensions [lists / 2, 2], but there are " + std::to_string(lists) + " lists");
  }
  const std::vector<std::uint32_t> cells = file.read<std::uint32_t>(name);
  std::vector<Boundary> boundaries(lists / 2);
  for (std::size_t b = 0; b < boundaries.size(); ++b) boundaries[b] = {cells[2 * b], cells[2 * b + 1]};
  try {
    BoundaryMap map(boundaries);
  } catch (const std::invalid_argument& error) {
    refuse_array(name, error.what());
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
    refuse_array(name, "must have a line of " + std::to_string(width) + " for each of the " +
                           std::to_string(ones) + " entries");
  }
  std::vector<float> numbers = file.read<float>(name);
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    if (!std::isfinite(numbers[i]))
      refuse_array(name, "entry " + std::to_string(i / width) + " is not a finite number");
  }
  return numbers;
}

std::optional<ObjectTree> read_tree(const Hdf5File& file, const std::string& group) {
  if (!file.contains(group)) return std::nullopt;
  const auto objects = file.number_attribute(group, "object_count");
  if (!objects || *objects >= ObjectTree::none)
    refuse_array(group, "needs an attribute object_count below 2^32 - 1");
  try {
    return ObjectTree::from_parents(file.read<std::uint32_t>(group + "/parent"),
                                    file.read<std::uint32_t>(group + "/object"),
                                    static_cast<std::uint32_t>(*objects));
  } catch (const std::invalid_argument& error) {
    refuse_array(group, error.what());
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

std::vector<ObjectLevel> read_levels(const Hdf5File& file) {
  const std::string name = column_levels_array;
  if (!file.contains(name)) return {};
  const auto dimensions = file.dimensions(name);
  if (dimensions.size() != 2 || dimensions[1] != 2)
    refuse_array(name, "must have dimensions [columns of the source, 2]");
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
  map.list_rows = read_groups(file, "/vismat/list_rows", shape.rows);
  map.boundaries = read_boundaries(file, map.lists_of(shape));
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
    refuse_array("/indices_1", "a row sees a node of " + tree_group + " but not its parent");
  return map;
}

[[noreturn]] void refuse_without_matrix(const Hdf5File& file) {
  const std::vector<std::string> groups = file.groups_with("binsparse");
  if (!groups.empty()) {
    std::string names;
    for (std::size_t i = 0; i < std::min<std::size_t>(groups.size(), 5); ++i)
      names += (i == 0 ? "" : ", ") + groups[i];
    if (groups.size() > 5) names += " and " + std::to_string(groups.size() - 5) + " more";
    throw FormatError("has no attribute 'binsparse' there: the matrix is in group " + names +
                      "; name it as FILE:" + groups[0]);
  }
  if (file.contains("/scene")) throw FormatError("holds a scene, not a matrix; 'vismat see' makes one of it");
  throw FormatError("has no attribute 'binsparse' on its root group or another: it holds no matrix");
}

}  // namespace

Dataset read_binsparse(const Hdf5File& file, MatrixNotes* notes) {
  const auto source = file.string_attribute("/", "binsparse");
  if (!source) refuse_without_matrix(file);
  Dataset dataset;
  dataset.matrix = read_binsparse_matrix(file, *source, notes);
  const Shape shape = dataset.matrix.shape();
  dataset.rows_are = file.string_attribute("/", "vismat_rows_are").value_or(dataset.rows_are);
  dataset.columns_are = file.string_attribute("/", "vismat_columns_are").value_or(dataset.columns_are);
  dataset.provenance = file.string_attribute("/", "vismat_provenance").value_or("");
  if (const auto guarantee = file.string_attribute("/", "vismat_guarantee")) {
    try {
      dataset.guarantee = guarantee_from_string(*guarantee);
    } catch (const std::invalid_argument& error) {
      refuse_array("attribute vismat_guarantee", error.what());
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
  assert(dataset.row_bounds.empty() || dataset.row_bounds.size() == matrix.shape().rows);
  assert(dataset.column_bounds.empty() || dataset.column_bounds.size() == matrix.shape().columns);
  write_binsparse_matrix(file, matrix);

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
  write_groups(file, "/vismat/list_rows", map.list_rows);
  write_tree(file, tree_group, map.tree);
  write_tree(file, row_tree_group, map.row_tree);
  write_names(file, row_names_array, map.row_names);
  write_names(file, column_names_array, map.column_names);
  write_levels(file, map.column_levels);
}

}  // namespace vismat
