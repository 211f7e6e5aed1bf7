// Cuts polygons into triangles that cover what their outlines enclose, and nothing else.
#pragma once
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

namespace vismat {

/// Triangulates polygons one after another. A polygon encloses what is inside of its outline by the even-odd rule: a ray from
/// there crosses the outline an odd number of times. So a loop within another is a hole, whichever way it runs, and an
/// outline that goes out along a line and back encloses nothing there. A polygon whose whole outline is repeated is that outline once.
class Triangulator {
 public:
  /// Appends to `triangles` three numbers of points for each triangle, which turn as the outline does. `outline` names 3 points or
  /// more in their order. A polygon that is not flat is looked at along the axis from which it looks largest. Where its outline
  /// crosses itself, `points` gets another point, rounded to a float. All corners of the outline become corners of triangles, those on
  /// straight lines too, but for those where it goes out and back. A polygon without area gives one triangle without area. O(n^2) for
  /// n corners, and O(n^3) at worst.
  void add(std::span<const std::uint32_t> outline, std::vector<glm::vec3>& points,
           std::vector<std::uint32_t>& triangles);

 private:
  using Ring = std::vector<std::uint32_t>;  // numbers in flat_; what it encloses lies to the left
  void flatten(std::span<const std::uint32_t> outline, const std::vector<glm::vec3>& points);
  double turn(std::uint32_t a, std::uint32_t b, std::uint32_t c) const;
  bool strictly_between(std::uint32_t p, std::uint32_t a, std::uint32_t b) const;
  bool touch(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) const;
  bool enters(std::uint32_t p, std::uint32_t q, std::uint32_t a, std::uint32_t b, std::uint32_t c) const;
  bool is_simple(const Ring& ring) const;
  bool is_ear(std::size_t before, std::size_t at, std::size_t after, bool simple) const;
  bool within_corner(const Ring& ring, std::size_t at, std::uint32_t d) const;
  bool blocked(const Ring& ring, std::uint32_t a, std::uint32_t b) const;
  void cut_ears(const Ring& ring, bool simple);
  void join_holes(Ring& outline, std::vector<Ring> holes) const;
  bool joined_by_a_corner(Ring& outline, const Ring& hole) const;
  void join_by_a_cut(Ring& outline, const std::vector<Ring>& holes) const;
  void cut_regions(std::span<const std::uint32_t> outline, std::vector<glm::vec3>& points);
  int winding(const glm::dvec2& at) const;
  glm::vec3 lifted(const glm::dvec2& at, std::span<const std::uint32_t> outline,
                   const std::vector<glm::vec3>& points) const;

  int axis_ = 0;
  bool mirrored_ = false;
  std::vector<glm::dvec2> flat_;  // the corners, then the crossings, on a grid of whole numbers
  Ring corners_;                  // without repeated points
  std::vector<std::uint32_t> left_, ears_;
  std::vector<std::uint32_t> point_of_;  // of each of flat_
  double step_ = 1;                      // of the grid
  glm::dvec3 origin_{};
};

}  // namespace vismat
