#include "matrix/dataset.h"

#include <array>
#include <cassert>
#include <stdexcept>

namespace vismat {
namespace {

constexpr std::array<std::string_view, 4> guarantee_names = {"unknown", "exact", "conservative",
                                                             "aggressive"};

std::vector<Box> moved(const std::vector<Box>& boxes, const Permutation& order) {
  std::vector<Box> result(boxes.size());
  for (std::size_t i = 0; i < boxes.size(); ++i) result[order.new_of_old()[i]] = boxes[i];
  return result;
}

// Boxes around each group's.
std::vector<Box> merged_boxes(const std::vector<Box>& boxes, const Partition& groups) {
  if (boxes.empty()) return {};
  std::vector<Box> result(groups.groups(), empty_box);
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    Box& whole = result[groups.group_of_member()[i]];
    whole = box_around(whole, boxes[i]);
  }
  return result;
}

// Groups touch where members do; none is its own neighbour.
VisibilityMatrix merged_neighbours(const VisibilityMatrix& neighbours, const Partition& groups) {
  const VisibilityMatrix whole = merge_columns(merge_rows(neighbours, groups), groups);
  std::vector<std::vector<std::uint32_t>> rows(groups.groups());
  for (std::uint32_t g = 0; g < groups.groups(); ++g) {
    rows[g].assign(whole.row(g).begin(), whole.row(g).end());
    std::erase(rows[g], g);
  }
  return VisibilityMatrix::from_rows(rows, groups.groups());
}

}  // namespace

std::string_view to_string(Guarantee guarantee) {
  return guarantee_names[static_cast<std::size_t>(guarantee)];
}

Guarantee guarantee_from_string(std::string_view name) {
  for (std::size_t i = 0; i < guarantee_names.size(); ++i) {
    if (guarantee_names[i] == name) return static_cast<Guarantee>(i);
  }
  throw std::invalid_argument("must be one of unknown, exact, conservative, aggressive");
}

namespace {
void drop_entries(Dataset& dataset) {
  dataset.sight_lines.clear();
  dataset.degree_of_visibility.clear();
}
}  // namespace

Dataset over_nodes(const Dataset& objects) {
  assert(objects.source.tree && !objects.source.columns_are_nodes);
  Dataset nodes = objects;
  nodes.matrix = nodes_from_objects(objects.matrix, *objects.source.tree);
  nodes.columns_are = "node";
  nodes.source = over_nodes(std::move(nodes.source));
  drop_entries(nodes);
  if (!objects.column_bounds.empty())
    nodes.column_bounds = node_bounds(*objects.source.tree, objects.column_bounds);
  return nodes;
}

Dataset reordered(Dataset dataset, const Permutation& rows, const Permutation& columns) {
  if (!rows.is_identity() || !columns.is_identity()) drop_entries(dataset);
  dataset.matrix = permute(std::move(dataset.matrix), rows, columns);
  dataset.row_bounds = moved(dataset.row_bounds, rows);
  dataset.column_bounds = moved(dataset.column_bounds, columns);
  if (dataset.row_neighbours)
    dataset.row_neighbours = permute(std::move(*dataset.row_neighbours), rows, rows);
  dataset.source = reordered(std::move(dataset.source), rows, columns);
  return dataset;
}

Dataset with_lists_in_place(Dataset dataset) {
  if (!dataset.source.list_rows) return dataset;
  drop_entries(dataset);
  dataset.matrix = expand_rows(dataset.matrix, *dataset.source.list_rows);
  dataset.row_bounds.clear();
  dataset.row_neighbours.reset();
  dataset.source.list_rows.reset();
  return dataset;
}

Dataset in_source_order(Dataset dataset) {
  dataset = with_lists_in_place(std::move(dataset));
  const auto [rows, columns] = dataset.matrix.shape();
  const SourceMap& source = dataset.source;
  const bool moves_rows = source.row_order && source.boundaries.empty();
  const Permutation row_back = moves_rows ? source.row_order->inverse() : Permutation::identity(rows),
                    column_back =
                        source.column_order ? source.column_order->inverse() : Permutation::identity(columns);
  dataset = reordered(std::move(dataset), row_back, column_back);
  if (moves_rows) dataset.source.row_order.reset();
  dataset.source.column_order.reset();
  return dataset;
}

Dataset merged(Dataset dataset, const std::optional<Partition>& rows,
               const std::optional<Partition>& columns) {
  if (rows || columns) drop_entries(dataset);
  if (rows) {
    dataset.matrix = merge_rows(dataset.matrix, *rows);
    dataset.row_bounds = merged_boxes(dataset.row_bounds, *rows);
    if (dataset.row_neighbours) dataset.row_neighbours = merged_neighbours(*dataset.row_neighbours, *rows);
  }
  if (columns) {
    dataset.matrix = merge_columns(dataset.matrix, *columns);
    dataset.column_bounds = merged_boxes(dataset.column_bounds, *columns);
  }
  dataset.source = merged(std::move(dataset.source), rows, columns);
  if (dataset.guarantee == Guarantee::exact) dataset.guarantee = Guarantee::conservative;
  if (dataset.guarantee == Guarantee::aggressive) dataset.guarantee = Guarantee::unknown;
  return dataset;
}

Dataset in_source_numbers(Dataset dataset) {
  SourceMap& source = dataset.source;
  const bool expands_rows = source.row_groups && source.boundaries.empty();
  if (expands_rows || source.column_groups) drop_entries(dataset);
  if (expands_rows) {
    dataset.matrix = expand_rows(dataset.matrix, *source.row_groups);
    source.row_groups.reset();
    dataset.row_bounds.clear();
    dataset.row_neighbours.reset();
    source.row_tree.reset();
  }
  if (source.column_groups) {
    dataset.matrix = expand_columns(dataset.matrix, *source.column_groups);
    source.column_groups.reset();
    dataset.column_bounds.clear();
    source.tree.reset();
    source.columns_are_nodes = false;
  }
  return in_source_order(std::move(dataset));
}

}  // namespace vismat
