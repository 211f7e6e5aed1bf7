// Makes view cells that are small where much is visible, by the adaptive octree of Chhugani et al. 2005, sections 3 and 8.
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

/// How many triangles are visible from each of the cells, which are the boxes of one level; called once a level.
using VisibleTriangles = std::function<std::vector<std::uint64_t>(const ViewCells& cells)>;

struct OctreeCellsOptions {
  std::uint64_t threshold = 100000;  // visible triangles; a cell with more is refined
  unsigned levels = 6;        // of refinement, at most 10; the smallest cell is the cube's side / 2^levels
  std::optional<Box> region;  // default: the scene's bounds
  Viewers viewers;
  unsigned threads = 0;  // 0: one a core; for finding where viewers are
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

/// Starts from the least cube over the region that shares its low corner. Only cells that lie in the region in part, and
/// that viewers reach in part, are counted, refined and kept: reachability is told on the grid of the smallest cells
/// (reachable_cells, where the memory goes: 8 lattice points each), and a larger cell is reachable where one of its
/// smallest is. So leaves do not overlap, and cover all of the smallest cells that viewers reach. Same scene, options and
/// counts, same cells. Throws std::invalid_argument for options out of range, where no cell is left, or where `count` gives
/// another number of counts than there are cells.
OctreeCells make_octree_cells(const Scene& scene, const VisibleTriangles& count,
                              const OctreeCellsOptions& options = {});

/// A line a level under a heading: side of its cells, cells evaluated, kept, stopped by the limit and how far over the
/// threshold those are.
std::string table_of(const OctreeCells& octree);

}  // namespace vismat
