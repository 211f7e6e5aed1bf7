// A visibility matrix with all that is known of it, which is what a `.bsp.h5` file holds: what the rows and columns are, where
// the matrix came from, how far it can be trusted, and the geometry that goes with it.
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

/// exact: lists what is visible and nothing else. conservative: may list hidden objects, and misses no visible one.
/// aggressive: may miss visible objects, and lists no hidden one.
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

  // Each is empty where it is not known.
  std::vector<Box> row_bounds, column_bounds;      // one a row, one a column
  std::optional<VisibilityMatrix> row_neighbours;  // rows x rows: which view cells touch
  /// One for each entry of the matrix, row by row. A sight line proves it: from a point of the view cell to a point of the object (x, y, z
  /// each). Degree of visibility: the part of all directions that the object takes, in [0, 1]. Both are left out where rows or
  /// columns change.
  std::vector<std::array<float, 6>> sight_lines;
  std::vector<float> degree_of_visibility;
  /// Orders, groups, trees, boundaries, names: how rows and columns relate to those of the source.
  SourceMap source;
  bool operator==(const Dataset&) const = default;
};

/// The same matrix over the tree's nodes instead of its objects (nodes_from_objects), tree kept; a node's box, where
/// boxes are known, is the least around its objects. Orders, groups and names of the objects cannot follow and are left out.
/// Needs a tree and columns that are objects.
Dataset over_nodes(const Dataset& objects);

/// Rows and columns in a new order, with all that goes by them: boxes, neighbours, and the source map as its own reordered()
/// says.
Dataset reordered(Dataset dataset, const Permutation& rows, const Permutation& columns);
/// Undoes what the source map's orders tell, and is without them. Rows that are differences stay as they are, and the order of
/// the view cells with them.
Dataset in_source_order(Dataset dataset);

/// Rows and columns merged into the groups' unions, with boxes around the members' and what else goes by them; an absent
/// partition leaves its side as it is. What was exact becomes conservative, what was aggressive unknown. The source map becomes
/// what its own merged() says. Needs a dataset without boundaries.
Dataset merged(Dataset dataset, const std::optional<Partition>& rows,
               const std::optional<Partition>& columns);
/// The matrix in the source's numbers: each of its rows and columns as its group. Geometry and trees of a merged side are left
/// out.
Dataset in_source_numbers(Dataset dataset);

}  // namespace vismat
