// Tells how the rows and columns of a matrix relate to those of the source that it was made from.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "matrix/deltas.h"
#include "matrix/object_tree.h"
#include "matrix/partition.h"
#include "matrix/permutation.h"

namespace vismat {

/// A column that is one level of detail of an object; level 0 is the finest.
struct ObjectLevel {
  std::uint32_t object = 0, level = 0;
  bool operator==(const ObjectLevel&) const = default;
};

/// Orders, groups, trees, boundaries and names, in one value that datasets, `.vmat` containers and row readers share. The
/// *source's* numbers are those that rows and columns had when the matrix was made; *present* numbers are those of the matrix as
/// it stands. An absent member says nothing: no order, no groups, no tree.
///
/// Where there are boundaries, the matrix's rows are lists of differences (Deltas), and everything said here of rows is said
/// of the view cells between which the boundaries lie.
struct SourceMap {
  /// Where the source's rows and columns stand now, if they were reordered.
  std::optional<Permutation> row_order, column_order;
  /// Which present row or column stands for each of the source's, if they were merged. Groups tell a later order too, so of a
  /// side there is an order, or groups, or neither.
  std::optional<Partition> row_groups, column_groups;
  /// A hierarchy over the present columns: its leafs name them. Where columns_are_nodes, each column is a node of it instead,
  /// and the matrix, unless it is one of differences, is monotone over the tree.
  std::optional<ObjectTree> tree;
  bool columns_are_nodes = false;
  /// A hierarchy over the present rows, which its leafs name as objects.
  std::optional<ObjectTree> row_tree;
  /// Between which view cells the rows are differences: two rows a boundary.
  std::vector<Boundary> boundaries;
  /// Of each of the source's rows and columns, in the source's numbers, whatever happens to the order: its name, UTF-8 without
  /// zero bytes; of which object it is which level of detail.
  std::vector<std::string> row_names, column_names;
  std::vector<ObjectLevel> column_levels;
  bool operator==(const SourceMap&) const = default;

  /// What the map says of rows is said of so many: the matrix's rows, or where there are boundaries the view cells.
  std::uint32_t rows_of(Shape shape) const;
  /// How many rows and columns the source had.
  Shape source_shape(Shape shape) const;
};

/// Throws std::invalid_argument, naming the member, where the map cannot be one of a matrix of this shape. Does not look
/// whether the matrix is monotone over its tree. O(nodes + boundaries + names).
void check_source_map(const SourceMap& map, Shape shape);

/// Differences once had a tree over their lists where now there is one over their view cells; it cannot be kept.
void drop_tree_over_lists(SourceMap& map, Shape shape);

/// The map of the matrix in a new order. A tree whose nodes are the columns cannot follow another order of columns and is left
/// out; boundaries cannot follow another order of rows and are left out, with what was said of the view cells.
SourceMap reordered(SourceMap map, const Permutation& rows, const Permutation& columns);
/// The map of the matrix whose rows or columns are merged into groups. Needs a map without boundaries. A tree over merged
/// rows, or whose nodes are merged columns, is left out; the objects in a tree over merged columns follow.
SourceMap merged(SourceMap map, const std::optional<Partition>& rows,
                 const std::optional<Partition>& columns);
/// The map of the same matrix over the nodes of its tree instead of its objects. What is said of objects cannot follow.
SourceMap over_nodes(SourceMap map);

}  // namespace vismat
