// Counts the triangles of an object that may face some point of a view cell; the others are back faces for all of it.
#pragma once
#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "matrix/dataset.h"
#include "visibility/geometry/mesh.h"
#include "visibility/geometry/point_bounds.h"

namespace vismat {

/// Whether the mesh is closed and its triangles face outward: as many run forward along each side as backward, and its
/// volume is above 0. No triangle of other objects may be culled for its direction. O(n log n).
bool is_closed_outward(const Mesh& mesh);

/// A tree over the triangles of one object, grouped by their normals and places [Chhugani et al. 2005, section 5, which
/// calls the groups clusters with normal cones]. Copies what it needs: about 100 bytes for each triangle.
class BackFaces {
 public:
  /// O(n log n). Deterministic.
  BackFaces(std::span<const glm::dvec3> vertices, std::span<const std::array<std::uint32_t, 3>> triangles);
  /// The number of triangles that may face some point of the closed cell: all but those that have the whole cell
  /// strictly behind their plane, by more than rounding can make. The number does not depend on the tree or its order.
  /// Takes far fewer steps than one for each triangle if groups face one way.
  std::uint64_t facing(const Box& cell) const;

 private:
  struct Plane {
    glm::dvec3 normal{}, corner{};
    /// How far the test of a cell near the scene may be off, for each metre of its coordinates.
    double rounding = 0;
  };
  struct Cluster {
    Bounds bounds;      // of its corners
    glm::dvec3 axis{};  // of a cone that holds all normals
    double sine = 2;    // of the cone's half angle; above 1 where it is not below a right angle
    std::uint32_t first = 0, count = 0;
    std::uint32_t next = 0;  // the first group that is not within this one
    bool leaf = false;
  };
  void build(std::span<std::uint32_t> order, std::uint32_t first, const std::vector<Plane>& planes,
             std::span<const glm::dvec3> vertices, std::span<const std::array<std::uint32_t, 3>> triangles);

  std::vector<Plane> planes_;
  std::vector<Cluster> clusters_;  // each before those within it
};

}  // namespace vismat
