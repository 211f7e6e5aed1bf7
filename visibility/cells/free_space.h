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

/// Boxes of one size side by side, numbered x first, then y, then z. Along an axis of size 0 there is one flat layer.
struct CellGrid {
  glm::dvec3 low{}, size{};
  std::array<std::uint32_t, 3> count{};
  std::uint64_t cells() const { return std::uint64_t{count[0]} * count[1] * count[2]; }
  std::uint64_t index(std::uint32_t x, std::uint32_t y, std::uint32_t z) const {
    return (std::uint64_t{z} * count[1] + y) * count[0] + x;
  }
  /// From cell (x, y, z), `step` cells long each way; boxes that touch have equal coordinates there.
  Box box(std::uint32_t x, std::uint32_t y, std::uint32_t z, std::uint32_t step = 1) const;
};

/// The least grid of such boxes that starts at the region's low corner and covers it. Throws std::invalid_argument where a
/// size is not above 0 (0 is allowed where the region is flat), or there would be more than 2^28 boxes.
CellGrid grid_over(const Box& region, const glm::vec3& size);

/// Where viewers are.
struct Viewers {
  /// They start at these points; empty: wherever there is nothing but sky straight above.
  std::vector<glm::vec3> from;
  /// They stand, eyes between these heights above what is below; empty: they fly.
  std::optional<std::array<float, 2>> eyes;
};

/// One entry for each cell of the grid: 1 if a viewer who starts where `viewers` says can get to some of it without crossing
/// a triangle. See-through objects are walls too. The way leads along lines of a lattice, `lines` a cell and axis, inside
/// the grid alone. So what is told reachable is, but for rays that slip through a crack between triangles that do not share
/// their vertices; a gap narrower than a cell / `lines` may not be found, nor such a sliver of a cell at the grid's border.
/// What lies within a closed surface is left out, whichever way its triangles face, unless viewers start there; open soups
/// enclose nothing. Where nothing at all is below, viewers with eyes stand on the grid's lower border. Throws
/// std::invalid_argument where a start lies outside of the grid. Two rays for each free stretch of a lattice line, a byte
/// for each lattice point. The same for any number of threads, on one kind of CPU.
std::vector<std::uint8_t> reachable_cells(const Scene& scene, const CellGrid& grid,
                                          const Viewers& viewers = {}, unsigned lines = 2,
                                          unsigned threads = 0);

}  // namespace vismat
