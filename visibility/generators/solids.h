// Makes closed bodies for generated scenes: boxes with boxes cut out of them, and surfaces stretched over rings.
#pragma once
#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "visibility/scene.h"

namespace vismat {

// All functions here add to the object that is being made, which has the number scene.object_count; the caller
// increments the count when the object has all its parts. Each body is closed, faces outward, and shares its vertices.

/// A body of filled voxels between axis-parallel planes. No two filled voxels may meet in an edge or a corner alone.
class Lattice {
 public:
  /// Puts planes through all of `cuts` on each axis (at least two, in any order), and more between them so that none is
  /// farther than `step` from the next. All voxels are empty.
  Lattice(std::array<std::vector<float>, 3> cuts, float step);
  /// Fills or empties the voxels whose middles lie in the box: exactly the box, if its sides are cuts.
  void set(const Box& box, bool filled);
  /// Whether the voxel is filled; indices may lie outside the grid, where all is empty.
  bool filled(const std::array<int, 3>& cell) const;
  void set_cell(const std::array<int, 3>& cell, bool filled);
  int cells(unsigned axis) const { return static_cast<int>(planes_[axis].size()) - 1; }
  const std::vector<float>& planes(unsigned axis) const { return planes_[axis]; }

  /// Adds two triangles for each side of a filled voxel behind which there is an empty one.
  void add_to(Scene& scene) const;

 private:
  std::size_t index(const std::array<int, 3>& cell) const;

  std::array<std::vector<float>, 3> planes_;
  std::vector<std::uint8_t> filled_;  // x runs fastest
};

/// Adds a whole box, its sides divided into squares of at most `step`.
void add_box(Scene& scene, const Box& box, float step);

/// Adds a surface over rings of equally many points, from one tip to another. Seen from the first tip, looking towards
/// the last, the points run counter-clockwise.
void add_loft(Scene& scene, const glm::vec3& first_tip, std::span<const std::vector<glm::vec3>> rings,
              const glm::vec3& last_tip);
/// One ring of a body of revolution: how far along the axis it lies and how wide it is (more than 0).
struct Turn {
  float along, radius;
};
/// Adds a body of revolution about the axis (unit length) through `base`. The profile ascends; flat or pointed ends lie
/// at its first and last tip.
void add_turned(Scene& scene, const glm::vec3& base, const glm::vec3& axis, float first_tip,
                std::span<const Turn> profile, float last_tip, unsigned sides);
/// `sides` points around `middle`, counter-clockwise when one looks along `axis` (unit length).
std::vector<glm::vec3> circle(const glm::vec3& middle, const glm::vec3& axis, float radius, unsigned sides);
/// The same, with the first point in the direction `start`, at right angles to the axis.
std::vector<glm::vec3> circle(const glm::vec3& middle, const glm::vec3& axis, const glm::vec3& start,
                              float radius, unsigned sides);

/// Adds an open sheet, the one thing here that is not closed: z = 0 from (0, 0) to (side, side), facing up, in squares
/// of at most `step`.
void add_ground(Scene& scene, float side, float step);

}  // namespace vismat
