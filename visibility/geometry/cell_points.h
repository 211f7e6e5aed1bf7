// Draws points of a view cell, where rays start.
#pragma once
#include <array>
#include <glm/vec3.hpp>
#include <optional>
#include <vector>

#include "matrix/base/random.h"
#include "visibility/geometry/convex.h"

namespace vismat {

/// Draws and tests points of one view cell. The points are floats that pass `contains`; only in a flat cell that is not
/// parallel to the axes, which may hold no floats at all, are they off by their rounding.
class CellPoints {
 public:
  explicit CellPoints(Convex cell);

  const Convex& cell() const { return cell_; }
  const glm::dvec3& centre() const { return centre_; }  // the mean of its vertices
  /// Whether the closed cell holds the point; the planes of a box are exact.
  bool contains(const glm::vec3& point) const;
  glm::vec3 vertex(std::size_t i) const { return within(cell_.vertices[i]); }
  glm::vec3 on_edge(Random& random) const;  // uniform by length; any vertex if the cell is a point
  glm::vec3 on_face(Random& random) const;  // uniform by area; on an edge if there is none
  /// The float of the cell that is nearest to a point of it, except for rounding.
  glm::vec3 within(const glm::dvec3& point) const;
  /// The first and the last t in [0, limit] for which from + t * direction lies in the cell; nothing if the cell is
  /// missed.
  std::optional<std::array<double, 2>> part_of(const glm::dvec3& from, const glm::dvec3& direction,
                                               double limit) const;
  /// A point that the cell and the closed triangle have in common; nothing if there is none.
  std::optional<glm::vec3> common_point(const std::array<glm::vec3, 3>& triangle) const;

 private:
  Convex cell_;
  glm::dvec3 centre_{};
  std::vector<std::array<std::uint16_t, 3>> triangles_;  // of the faces
  std::vector<double> area_up_to_, length_up_to_;        // running sums over triangles_ and the edges
};

}  // namespace vismat
