// Makes view cells of equal size wherever a viewer can be.
#pragma once
#include <glm/vec3.hpp>
#include <optional>

#include "visibility/cells/free_space.h"
#include "visibility/scene.h"
#include "visibility/view_cells.h"

namespace vismat {

struct GridCellsOptions {
  glm::vec3 size{4, 4, 4};    // of a cell, metres
  std::optional<Box> region;  // default: the scene's bounds
  Viewers viewers;
  unsigned threads = 0;  // 0: one for each core; the cells are the same for any number
};

/// Boxes side by side from the region's low corner on, with their neighbours, in Z-order. Where a region is given that is no
/// multiple of the size, they are evenly smaller, so that they end with it. Only those are kept that
/// viewers can reach, as reachable_cells finds them: a cell that a wall cuts is kept whole, and counts for both sides.
/// The same scene and options give the same cells, on one kind of CPU. Throws std::invalid_argument for options out of
/// range, or if no cell is left.
ViewCells make_grid_cells(const Scene& scene, const GridCellsOptions& options = {});

}  // namespace vismat
