// Makes view cells that are small where much is visible, as the adaptive octree of Chhugani et al. 2005, sections 3 and
// 8.
#pragma once
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "visibility/cells/free_space.h"
#include "visibility/scene.h"
#include "visibility/view_cells.h"

namespace vismat {

/// Counts how many triangles are visible from each of the cells, which are the boxes of one level. Is called once for
/// each level.
using VisibleTriangles = std::function<std::vector<std::uint64_t>(const ViewCells& cells)>;

struct OctreeCellsOptions {
  std::uint64_t threshold = 100000;  // visible triangles; a cell with more is refined
  unsigned levels = 6;        // of refinement, at most 10; the smallest cell is the cube's side / 2^levels
  std::optional<Box> region;  // default: the scene's bounds
  Viewers viewers;
  unsigned threads = 0;  // 0: one for each core; for finding what viewers reach
};

struct OctreeLevel {
  std::uint64_t evaluated = 0;  // cells whose triangles were counted
  std::uint64_t kept = 0;       // of those, view cells of the result; the others were refined
  std::uint64_t stopped = 0;    // of those kept, with more triangles than the threshold: the level limit
  double excess = 0;            // their mean number of triangles / threshold; 0 where there are none
};

struct OctreeCells {
  ViewCells cells;                       // cubes in Z-order, with their neighbours
  std::vector<std::uint64_t> triangles;  // visible from each cell
  double side = 0;                       // of the root, metres
  std::vector<OctreeLevel> levels;       // the root's first, as many as were needed
};

/// Starts from the smallest cube over the region that shares its low corner. Where a region is given, the smallest cells
/// are evenly smaller, so that they end with it, and larger ones are cut there. Only cells that lie at least partly in the
/// region and that viewers can reach at least in part are counted, divided and kept. What can be reached is found on
/// the grid of the smallest cells (by reachable_cells, which takes most of the memory: 8 lattice points for each of
/// them); a larger cell is reachable if one of its smallest cells is. So leaves do not overlap, and cover all of the
/// smallest cells that viewers reach. The same scene, options and counts give the same cells. Throws
/// std::invalid_argument for options out of range, if no cell is left, or if `count` returns another number of counts
/// than there are cells.
OctreeCells make_octree_cells(const Scene& scene, const VisibleTriangles& count,
                              const OctreeCellsOptions& options = {});

/// A table with a heading and a line for each level: the side of its cells; how many cells were evaluated, kept, and
/// stopped by the limit on levels; and how far those are above the threshold.
std::string table_of(const OctreeCells& octree);

}  // namespace vismat
