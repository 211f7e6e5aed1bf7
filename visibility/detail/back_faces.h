// Counts the triangles of an object that may face some point of a view cell; the others are back faces for all of it.
#pragma once
#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "matrix/dataset.h"
#include "visibility/geometry/bounds.h"
#include "visibility/geometry/mesh.h"

namespace vismat {

/// Closed, with triangles that face outward: as many run forward along each side as backward, and the volume is above 0.
/// Of other objects no triangle may be culled for its direction. O(n log n).
bool is_closed_outward(const Mesh& mesh);

/// A hierarchy over triangles of one object, by their normals and places [Chhugani et al. 2005, section 5: clusters with
/// normal cones]. Copies what it needs: about 100 bytes a triangle.
class BackFaces {
 public:
  /// O(n log n). Deterministic.
  BackFaces(std::span<const glm::dvec3> vertices, std::span<const std::array<std::uint32_t, 3>> triangles);
  /// How many triangles may face some point of the cell, closed: all but those whose plane has the whole cell strictly
  /// behind it, by more than rounding can make. Neither the hierarchy nor its order shows in the number. Far below one step a
  /// triangle where clusters face one way.
  std::uint64_t facing(const Box& cell) const;

 private:
  struct Plane {
    glm::dvec3 normal{}, corner{};
    /// What the test of a cell near the scene may be off by, for each metre of its coordinates.
    double rounding = 0;
  };
  struct Cluster {
    Bounds bounds;      // of its corners
    glm::dvec3 axis{};  // of a cone that holds all normals
    double sine = 2;    // of the cone's half angle; above 1 where it is not below a right angle
    std::uint32_t first = 0, count = 0;
    std::uint32_t next = 0;  // the first cluster that is not within this one
    bool leaf = false;
  };
  void build(std::span<std::uint32_t> order, std::uint32_t first, const std::vector<Plane>& planes,
             std::span<const glm::dvec3> vertices, std::span<const std::array<std::uint32_t, 3>> triangles);

  std::vector<Plane> planes_;
  std::vector<Cluster> clusters_;  // each before those within it
};

}  // namespace vismat
