// Finds the free space of a scene that a viewer can reach.
#pragma once
#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <vector>

#include "matrix/dataset.h"
#include "visibility/scene.h"

namespace vismat {

/// A grid of boxes of one size, numbered along x first, then y, then z. Along an axis of size 0 there is one flat
/// layer.
struct CellGrid {
  glm::dvec3 low{}, size{};
  std::array<std::uint32_t, 3> count{};
  std::uint64_t cells() const { return std::uint64_t{count[0]} * count[1] * count[2]; }
  std::uint64_t index(std::uint32_t x, std::uint32_t y, std::uint32_t z) const {
    return (std::uint64_t{z} * count[1] + y) * count[0] + x;
  }
  /// The box of `step` cells each way from cell (x, y, z); boxes that touch have equal coordinates there.
  Box box(std::uint32_t x, std::uint32_t y, std::uint32_t z, std::uint32_t step = 1) const;
};

/// The smallest grid of such boxes that starts at the region's low corner and covers it. Throws std::invalid_argument
/// if a size is not above 0 (0 is allowed where the region is flat), or if there would be more than 2^28 boxes.
CellGrid grid_over(const Box& region, const glm::vec3& size);
/// Makes the boxes evenly smaller, so that they end where the region ends.
void fit(CellGrid& grid, const Box& region);

/// Where viewers start, and how they move.
struct Viewers {
  /// The points at which they start; empty: wherever there is only sky straight above.
  std::vector<glm::vec3> from;
  /// If given, they stand, with their eyes between these heights above what is below; otherwise they fly.
  std::optional<std::array<float, 2>> eyes;
};

/// One entry for each cell of the grid: 1 if a viewer who starts where `viewers` says can reach some part of it without
/// crossing a triangle. See-through objects are walls too. The viewer moves along the lines of a lattice, `lines` of
/// them for each cell and axis, within the grid. A cell reported reachable is reachable, except if a ray slips through
/// a crack between triangles that share no vertices. Gaps narrower than cell / `lines` may be missed, and so may
/// slivers of cells at the grid's border that are as narrow. What lies within a closed surface is left out, whichever
/// way its triangles face, unless viewers start there; open soups of triangles enclose nothing. Where there is nothing
/// at all below them, viewers with eyes stand on the grid's lower border. Throws std::invalid_argument if a start lies
/// outside the grid. Casts two rays for each free stretch of a lattice line, and takes a byte for each lattice point.
/// The result is the same for any number of threads, on one kind of CPU.
std::vector<std::uint8_t> reachable_cells(const Scene& scene, const CellGrid& grid,
                                          const Viewers& viewers = {}, unsigned lines = 2,
                                          unsigned threads = 0);

}  // namespace vismat
