// Finds in which cell of a level a point lies.
#pragma once
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "matrix/box.h"
#include "visibility/levels/level_tree.h"

namespace vismat {

/// The level's own BSP tree with its planes, in metres. Empty if a level has none.
struct LevelPlaces {
  struct Plane {
    glm::vec3 normal{};
    float distance = 0;  // in front: dot(normal, x) >= distance
  };
  struct Node {
    std::uint32_t plane = 0;
    BspChildren children{};
  };
  std::vector<Plane> planes;
  std::vector<Node> nodes;                 // the first is the root
  std::vector<std::int32_t> cell_of_leaf;  // negative: within walls, or outside the level
};

/// A part of a segment, `from` and `to` in [0, 1] along it, and the cell in which it lies.
struct Stay {
  std::int32_t cell = -1;
  double from = 0, to = 1;
};
/// The cells through which a segment passes, in order; neighbouring parts in one cell are joined. `places` must not be
/// empty.
std::vector<Stay> stays_along(const LevelPlaces& places, const glm::dvec3& from, const glm::dvec3& to);
std::int32_t cell_at(const LevelPlaces& places, const glm::dvec3& point);
/// Whether one of 6 x 6 x 6 points, spread evenly over the inside of the box, lies in a cell. Walls cut off parts of a box that
/// are thinner than a sixth of it, which may be missed.
bool has_point_in_cell(const LevelPlaces& places, const Box& box);

}  // namespace vismat
