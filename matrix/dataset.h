// A visibility matrix with all that is known about it, which is what a `.bsp.h5` file holds: what the rows and columns
// are, where the matrix came from, how far it can be trusted, and the geometry that goes with it.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "matrix/box.h"
#include "matrix/source_map.h"
#include "matrix/visibility_matrix.h"

namespace vismat {

/// Whether the matrix lists what is visible. exact: it lists exactly the visible objects. conservative: it may list
/// hidden objects, but misses no visible one. aggressive: it may miss visible objects, but lists no hidden one.
enum class Guarantee { unknown, exact, conservative, aggressive };
std::string_view to_string(Guarantee guarantee);
Guarantee guarantee_from_string(
    std::string_view name);  // throws std::invalid_argument listing the right ones

struct Dataset {
  VisibilityMatrix matrix;
  std::string rows_are = "view cell", columns_are = "object";
  std::string provenance;  // one line: the file, generator or producer with its parameters
  Guarantee guarantee = Guarantee::unknown;
  std::optional<std::uint64_t> seed;

  // Each of the following is empty if it is not known.
  std::vector<Box> row_bounds, column_bounds;      // a box for each row, and for each column
  std::optional<VisibilityMatrix> row_neighbours;  // rows x rows: which view cells touch
  /// Each of these has an item for each entry of the matrix, row by row, and is left out when rows or columns change. A
  /// sight line, which proves the entry, runs from a point of the view cell to a point of the object (x, y, z of each).
  /// The degree of visibility is the share of all directions that the object takes, in [0, 1].
  std::vector<std::array<float, 6>> sight_lines;
  std::vector<float> degree_of_visibility;
  /// How rows and columns relate to those of the source: orders, groups, trees, boundaries, names.
  SourceMap source;
  bool operator==(const Dataset&) const = default;
};

/// The same matrix with the tree's nodes as columns instead of its objects (nodes_from_objects); the tree is kept. If
/// boxes are known, a node's box is the smallest around its objects. Orders, groups and names of the objects have no
/// meaning for nodes and are left out. Needs a tree and columns that are objects.
Dataset over_nodes(const Dataset& objects);

/// The dataset in a new order, with boxes, neighbours and the source map reordered too (see reordered() in
/// source_map.h).
Dataset reordered(Dataset dataset, const Permutation& rows, const Permutation& columns);
/// The dataset with list i of the boundaries in row i, without list_rows; any other is given back as it is.
Dataset with_lists_in_place(Dataset dataset);
/// The dataset in the source's order, without stored orders. Lists of differences are in place; the order of their view
/// cells stays as it is.
Dataset in_source_order(Dataset dataset);

/// The dataset with its rows and columns merged into the unions of the groups; boxes are those around the members', and
/// neighbours are merged too. Without a partition a side stays as it is. An exact matrix becomes conservative, an
/// aggressive one unknown. The source map is merged as merged() in source_map.h says.
Dataset merged(Dataset dataset, const std::optional<Partition>& rows,
               const std::optional<Partition>& columns);
/// The matrix in the source's numbers: each of the source's rows and columns as its group has it. Geometry and trees of
/// a merged side are left out.
Dataset in_source_numbers(Dataset dataset);

}  // namespace vismat
