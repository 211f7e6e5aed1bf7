// Makes the view cells that a user asks for in words.
#pragma once
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "visibility/cells/grid_cells.h"
#include "visibility/cells/ground_cells.h"
#include "visibility/cells/octree_cells.h"
#include "visibility/view_cells.h"

namespace vismat {

/// The words of a command line, as they stand there.
struct CellsWords {
  /// file | grid:SIZE | grid:X,Y,Z | ground | ground:HEIGHT | octree:TRIANGLES | octree:TRIANGLES:LEVELS
  std::string cells = "file";
  std::string region;             // "x,y,z,x,y,z": the low corner and the high one; empty: the scene's bounds
  std::vector<std::string> from;  // "x,y,z" each
  std::string eyes;  // "low,high" or one height; empty: 1.6 m on the ground, elsewhere viewers fly
};

/// What they mean; std::monostate: the cells that the scene file has.
using CellsChoice = std::variant<std::monostate, GridCellsOptions, GroundCellsOptions, OctreeCellsOptions>;

/// Throws std::invalid_argument, which says what was expected, for words that mean nothing.
CellsChoice parse_cells(const CellsWords& words);

/// The same choice in one line, every parameter named; equal choices give equal lines.
std::string describe(const CellsChoice& choice);

struct ChosenCells {
  ViewCells cells;
  std::string table;  // of an octree's levels; otherwise empty
};

/// Makes the cells. `of_file` is what the scene file has: taken where the choice is to keep it, which throws
/// std::invalid_argument if it has none. `count` serves octrees alone. Throws as the makers do.
ChosenCells choose_cells(const Scene& scene, const ViewCells& of_file, const CellsChoice& choice,
                         const VisibleTriangles& count);

/// For each row of cells x objects, how many triangles its objects have.
std::vector<std::uint64_t> triangles_of_rows(const VisibilityMatrix& objects, const Scene& scene);

}  // namespace vismat
