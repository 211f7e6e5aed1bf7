#include "matrix/source_map.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace vismat {
namespace {

ObjectTree with_objects(const ObjectTree& tree, std::span<const std::uint32_t> new_of_old,
                        std::uint32_t count) {
  std::vector<std::uint32_t> parents(tree.parent_of_node().begin(), tree.parent_of_node().end());
  std::vector<std::uint32_t> objects(tree.object_of_node().begin(), tree.object_of_node().end());
  for (std::uint32_t& object : objects) {
    if (object != ObjectTree::none) object = new_of_old[object];
  }
  return ObjectTree::from_parents(std::move(parents), std::move(objects), count);
}

// From the source's numbers to the groups of what stands there now.
Partition from_source(const std::optional<Partition>& groups, const std::optional<Permutation>& order,
                      const Partition& then) {
  if (groups) return followed_by(*groups, then);
  if (!order) return then;
  return followed_by(renumbered(Partition::identity(order->size()), *order), then);
}

Permutation followed_by(const std::optional<Permutation>& first, const Permutation& then) {
  if (!first) return then;
  std::vector<std::uint32_t> map(first->new_of_old().begin(), first->new_of_old().end());
  for (std::uint32_t& place : map) place = then.new_of_old()[place];
  return Permutation::from_new_of_old(std::move(map));
}

void put_in_order(std::optional<Partition>& groups, std::optional<Permutation>& order,
                  const Permutation& then) {
  if (groups)
    groups = renumbered(*groups, then);
  else if (order || !then.is_identity())
    order = followed_by(order, then);
}

void need(const char* member, std::uint64_t has, const char* of, std::uint64_t wanted, const char* counted) {
  if (has == wanted) return;
  throw std::invalid_argument(std::string(member) + ": has " + std::to_string(has) + " " + of +
                              ", but there are " + std::to_string(wanted) + " " + counted);
}

void check_side(const std::optional<Permutation>& order, const std::optional<Partition>& groups,
                std::uint32_t count, const char* order_member, const char* groups_member,
                const char* counted) {
  if (order && groups)
    throw std::invalid_argument(std::string(groups_member) + ": stand beside " + order_member +
                                "; the groups tell the order too");
  if (order) need(order_member, order->size(), "places", count, counted);
  if (groups) need(groups_member, groups->groups(), "groups", count, counted);
}

void check_names(const std::vector<std::string>& names, std::uint32_t count, const char* member,
                 const char* counted) {
  if (names.empty()) return;
  need(member, names.size(), "names", count, counted);
  const auto bad =
      std::ranges::find_if(names, [](const std::string& n) { return n.find('\0') != std::string::npos; });
  if (bad != names.end())
    throw std::invalid_argument(std::string(member) + ": name " + std::to_string(bad - names.begin()) +
                                " holds a zero byte");
}

}  // namespace

std::uint32_t SourceMap::rows_of(Shape shape) const {
  if (boundaries.empty()) return shape.rows;
  std::uint32_t cells = 0;
  for (const Boundary& b : boundaries) cells = std::max(cells, b.to + 1);  // from < to
  return cells;
}

Shape SourceMap::source_shape(Shape shape) const {
  return {row_groups ? row_groups->size() : rows_of(shape),
          column_groups ? column_groups->size() : shape.columns};
}

void check_source_map(const SourceMap& map, Shape shape) {
  if (!map.boundaries.empty()) {
    need("boundaries", 2 * std::uint64_t{map.boundaries.size()}, "lists", map.lists_of(shape),
         map.list_rows ? "lists in list_rows" : "rows");
    if (map.list_rows) need("list_rows", map.list_rows->groups(), "groups", shape.rows, "rows");
    try {
      BoundaryMap{map.boundaries};
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument(std::string("boundaries: ") + error.what());
    }
  } else if (map.list_rows) {
    throw std::invalid_argument("list_rows: stand without boundaries, whose lists they are");
  }
  const std::uint32_t rows = map.rows_of(shape), columns = shape.columns;
  const char* const counted = map.boundaries.empty() ? "rows" : "view cells between the boundaries";
  check_side(map.row_order, map.row_groups, rows, "row_order", "row_groups", counted);
  check_side(map.column_order, map.column_groups, columns, "column_order", "column_groups", "columns");
  if (map.row_tree) need("row_tree", map.row_tree->object_count(), "objects", rows, counted);
  if (map.columns_are_nodes && !map.tree)
    throw std::invalid_argument("tree: is missing, though the columns are said to be its nodes");
  if (map.tree && map.columns_are_nodes) need("tree", map.tree->size(), "nodes", columns, "columns");
  if (map.tree && !map.columns_are_nodes)
    need("tree", map.tree->object_count(), "objects", columns, "columns");
  const Shape source = map.source_shape(shape);
  check_names(map.row_names, source.rows, "row_names", "rows of the source");
  check_names(map.column_names, source.columns, "column_names", "columns of the source");
  if (!map.column_levels.empty())
    need("column_levels", map.column_levels.size(), "columns", source.columns, "columns of the source");
}

void drop_tree_over_lists(SourceMap& map, Shape shape) {
  if (map.row_tree && map.row_tree->object_count() == shape.rows && map.rows_of(shape) != shape.rows)
    map.row_tree.reset();
}

SourceMap reordered(SourceMap map, const Permutation& rows, const Permutation& columns) {
  if (map.tree && !columns.is_identity()) {
    if (map.columns_are_nodes)
      map.tree.reset();
    else
      map.tree = with_objects(*map.tree, columns.new_of_old(), columns.size());
    map.columns_are_nodes = false;
  }
  if (map.boundaries.empty()) {
    if (map.row_tree && !rows.is_identity())
      map.row_tree = with_objects(*map.row_tree, rows.new_of_old(), rows.size());
    put_in_order(map.row_groups, map.row_order, rows);
  } else if (map.list_rows || !rows.is_identity()) {
    map.list_rows = renumbered(map.list_rows ? *map.list_rows : Partition::identity(rows.size()), rows);
  }
  put_in_order(map.column_groups, map.column_order, columns);
  return map;
}

SourceMap merged(SourceMap map, const std::optional<Partition>& rows,
                 const std::optional<Partition>& columns) {
  if (rows && !map.boundaries.empty()) {
    map.list_rows = map.list_rows ? followed_by(*map.list_rows, *rows) : *rows;
  } else if (rows) {
    map.row_groups = from_source(map.row_groups, map.row_order, *rows);
    map.row_order.reset();
    map.row_tree.reset();
  }
  if (columns) {
    map.column_groups = from_source(map.column_groups, map.column_order, *columns);
    map.column_order.reset();
    if (map.columns_are_nodes)
      map.tree.reset();
    else if (map.tree)
      map.tree = with_objects(*map.tree, columns->group_of_member(), columns->groups());
    map.columns_are_nodes = false;
  }
  return map;
}

SourceMap over_nodes(SourceMap map) {
  map.columns_are_nodes = true;
  map.column_order.reset();
  map.column_groups.reset();
  map.column_names.clear();
  map.column_levels.clear();
  return map;
}

}  // namespace vismat
