// Makes the view cells that the options --cells, --region, --from and --eyes ask for.
#pragma once
#include <array>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "visibility/cells/grid_cells.h"
#include "visibility/cells/ground_cells.h"
#include "visibility/cells/octree_cells.h"
#include "visibility/view_cells.h"

namespace vismat {

/// The values of these options as the command line gives them.
struct CellsWords {
  /// file | grid:SIZE | grid:X,Y,Z | ground | ground:HEIGHT | octree:TRIANGLES | octree:TRIANGLES:LEVELS
  std::string cells = "file";
  std::string region;             // "x,y,z,x,y,z": the low corner and the high one; empty: the scene's bounds
  std::vector<std::string> from;  // "x,y,z" each
  std::string eyes;  // "low,high" or one height; empty: 1.6 m on the ground, elsewhere viewers fly
};

/// What the words mean; std::monostate stands for the cells of the scene file.
using CellsChoice = std::variant<std::monostate, GridCellsOptions, GroundCellsOptions, OctreeCellsOptions>;

/// Throws std::invalid_argument, which says what was expected, for words without a meaning.
/// Coordinates are those of the file that the scene was made from; `origin` is the scene's place there (SceneFile::origin).
CellsChoice parse_cells(const CellsWords& words, const std::array<double, 3>& origin = {});

/// The choice in one line that names every parameter; equal choices give equal lines.
std::string describe(const CellsChoice& choice);

struct ChosenCells {
  ViewCells cells;
  std::string table;  // the levels of an octree (table_of); otherwise empty
};

/// Makes the cells. `of_file` are the cells of the scene file; they are returned if the choice is to keep them, which
/// throws std::invalid_argument if there are none. `count` is used only for octrees. Throws as the makers of cells do.
ChosenCells choose_cells(const Scene& scene, const ViewCells& of_file, const CellsChoice& choice,
                         const VisibleTriangles& count);

/// For each row of a matrix of cells x objects, the number of triangles that its objects have.
std::vector<std::uint64_t> triangles_of_rows(const VisibilityMatrix& objects, const Scene& scene);

}  // namespace vismat
