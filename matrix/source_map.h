// How the rows and columns of a matrix relate to those of the source that it was made from.
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

/// Which level of detail of which object a column is; level 0 is the finest.
struct ObjectLevel {
  std::uint32_t object = 0, level = 0;
  bool operator==(const ObjectLevel&) const = default;
};

/// Orders, groups, trees, boundaries and names, in one value that datasets, `.vmat` containers and row readers share.
/// The *source's* numbers are those that rows and columns had when the matrix was made; *present* numbers are those of
/// the matrix as it is now. A member that is absent says that there is no such thing: no order, no groups, no tree.
///
/// If there are boundaries, the matrix's rows are lists of differences (Deltas), and everything but list_rows that is
/// said here about rows refers to the view cells between which the boundaries lie.
struct SourceMap {
  /// The present place of each of the source's rows and columns, if they were reordered.
  std::optional<Permutation> row_order, column_order;
  /// The present row or column that stands for each of the source's, if they were merged. Groups include any later
  /// order, so a side has an order or groups, never both.
  std::optional<Partition> row_groups, column_groups;
  /// A tree over the present columns, which its leaves hold as objects. If columns_are_nodes, each column is a node of
  /// the tree instead, and the matrix, unless it holds differences, is monotone over it.
  std::optional<ObjectTree> tree;
  bool columns_are_nodes = false;
  /// A tree over the present rows, which its leaves hold as objects.
  std::optional<ObjectTree> row_tree;
  /// The view cells between which the rows are differences: two lists for each boundary (Deltas).
  std::vector<Boundary> boundaries;
  /// The present row that holds each of the boundaries' lists, if lists were reordered or equal ones stored once.
  /// Absent: row i is list i.
  std::optional<Partition> list_rows;
  /// For each of the source's rows and columns, in the source's numbers whatever the present order is: its name (UTF-8
  /// without zero bytes); and for columns, which level of detail of which object it is.
  std::vector<std::string> row_names, column_names;
  std::vector<ObjectLevel> column_levels;
  bool operator==(const SourceMap&) const = default;

  /// The number of rows that orders, groups and names refer to: the matrix's rows or, for differences, the view cells.
  std::uint32_t rows_of(Shape shape) const;
  /// The number of lists of differences that the matrix's rows hold.
  std::uint32_t lists_of(Shape shape) const { return list_rows ? list_rows->size() : shape.rows; }
  /// The number of rows and columns that the source had.
  Shape source_shape(Shape shape) const;
};

/// Throws std::invalid_argument, naming the member, if the map cannot belong to a matrix of this shape. Does not check
/// whether the matrix is monotone over its tree. O(nodes + boundaries + names).
void check_source_map(const SourceMap& map, Shape shape);

/// Removes a row tree that an older version made: for differences it stood over the lists, but now it must stand over
/// the view cells.
void drop_tree_over_lists(SourceMap& map, Shape shape);

/// The map of the matrix in a new order. A tree whose nodes are the columns cannot follow a new order of columns and is
/// left out.
SourceMap reordered(SourceMap map, const Permutation& rows, const Permutation& columns);
/// The map of the matrix whose rows or columns are merged into groups. A tree over merged rows is left out, and so is
/// one whose nodes are merged columns; in a tree over merged columns the objects are replaced by their groups. Lists of
/// differences may only be merged with equal ones.
SourceMap merged(SourceMap map, const std::optional<Partition>& rows,
                 const std::optional<Partition>& columns);
/// The map of the same matrix with the nodes of its tree as columns instead of its objects. What refers to objects is
/// left out.
SourceMap over_nodes(SourceMap map);

}  // namespace vismat
