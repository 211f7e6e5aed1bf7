// Makes closed bodies for generated scenes: boxes with boxes cut out of them, and surfaces stretched over rings.
#pragma once
#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "visibility/scene.h"

namespace vismat {

/// What is added becomes part of the object that is being made, number scene.object_count; the caller counts it when it
/// has all its parts. Each body is closed, outward oriented, and shares its vertices.
///
/// A body of filled cells between axis-parallel planes. No two filled cells may meet in an edge or a corner alone.
class Lattice {
 public:
  /// Planes through all of `cuts` on each axis (two at least, in any order), and between them so that none is farther than
  /// `step` from the next. All cells are empty.
  Lattice(std::array<std::vector<float>, 3> cuts, float step);
  /// Fills or empties the cells whose middles lie in the box: exactly the box, if its sides are cuts.
  void set(const Box& box, bool filled);
  /// Filled cells of the grid; indices may lie outside, where all is empty.
  bool filled(const std::array<int, 3>& cell) const;
  void set_cell(const std::array<int, 3>& cell, bool filled);
  int cells(unsigned axis) const { return static_cast<int>(planes_[axis].size()) - 1; }
  const std::vector<float>& planes(unsigned axis) const { return planes_[axis]; }

  /// Two triangles for each side of a filled cell that an empty one is behind.
  void add_to(Scene& scene) const;

 private:
  std::size_t index(const std::array<int, 3>& cell) const;

  std::array<std::vector<float>, 3> planes_;
  std::vector<std::uint8_t> filled_;  // x runs fastest
};

/// A whole box in squares of at most `step`.
void add_box(Scene& scene, const Box& box, float step);

/// A surface over rings of equally many points, from one tip to another. Seen from the first tip, looking towards the last,
/// the points run counter-clockwise.
void add_loft(Scene& scene, const glm::vec3& first_tip, std::span<const std::vector<glm::vec3>> rings,
              const glm::vec3& last_tip);
/// A body of revolution about the axis (unit length) through `base`. The profile lists how far along it and how wide (more
/// than 0), ascending; flat or pointed ends lie at its first and last tip.
struct Turn {
  float along, radius;
};
void add_turned(Scene& scene, const glm::vec3& base, const glm::vec3& axis, float first_tip,
                std::span<const Turn> profile, float last_tip, unsigned sides);
/// `sides` points round `middle`, counter-clockwise when one looks along `axis` (unit length).
std::vector<glm::vec3> circle(const glm::vec3& middle, const glm::vec3& axis, float radius, unsigned sides);
/// The first point in the direction `start`, at right angles to the axis.
std::vector<glm::vec3> circle(const glm::vec3& middle, const glm::vec3& axis, const glm::vec3& start,
                              float radius, unsigned sides);

/// An open sheet, the one thing here that is not closed: z = 0 from (0, 0) to (side, side), facing up, in squares of `step` at
/// most.
void add_ground(Scene& scene, float side, float step);

}  // namespace vismat
