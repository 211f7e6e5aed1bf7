// ALGORITHM. free_space.cpp finds which boxes viewers reach. Z-order keeps cells that see similar objects together, so
// that similar rows are near in the matrix; in x, y, z order such neighbours are near along one axis only.
#include "visibility/cells/grid_cells.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "matrix/base/z_order.h"
#include "visibility/geometry/touching_boxes.h"

namespace vismat {

ViewCells make_grid_cells(const Scene& scene, const GridCellsOptions& options) {
  CellGrid grid = grid_over(options.region ? *options.region : bounds_of(scene), options.size);
  if (options.region) fit(grid, *options.region);
  const std::vector<std::uint8_t> reachable =
      reachable_cells(scene, grid, options.viewers, 2, options.threads);
  std::vector<std::pair<std::uint64_t, std::array<std::uint32_t, 3>>> kept;
  for (std::uint32_t z = 0; z < grid.count[2]; ++z) {
    for (std::uint32_t y = 0; y < grid.count[1]; ++y) {
      for (std::uint32_t x = 0; x < grid.count[0]; ++x) {
        if (reachable[grid.index(x, y, z)]) kept.push_back({z_order(x, y, z), {x, y, z}});
      }
    }
  }
  if (kept.empty()) throw std::invalid_argument("view cells: viewers reach none of the region");
  std::sort(kept.begin(), kept.end());
  ViewCells cells;
  for (const auto& [key, at] : kept) cells.boxes.push_back(grid.box(at[0], at[1], at[2]));
  cells.neighbours = touching_boxes(cells.boxes);
  return cells;
}

}  // namespace vismat
