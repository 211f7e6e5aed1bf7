// Ground as triangles: constrained Delaunay triangulation by GEOS, and which triangles meet.
#pragma once
#include <geos_c.h>

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "matrix/dataset.h"

namespace vismat {

/// GEOS by its C interface, the one that stays stable between versions; frees what it hands out. For one thread.
class Geos {
 public:
  struct Delete {
    GEOSContextHandle_t context;
    void operator()(GEOSGeometry* geometry) const { GEOSGeom_destroy_r(context, geometry); }
  };
  using Geometry = std::unique_ptr<GEOSGeometry, Delete>;

  Geos();
  ~Geos();
  Geos(const Geos&) = delete;
  Geos& operator=(const Geos&) = delete;

  /// Throws std::runtime_error with what GEOS says where there is no geometry.
  Geometry own(GEOSGeometry* geometry) const;
  /// The corners in order; the ring closes itself.
  GEOSGeometry* ring(std::span<const glm::dvec2> corners) const;
  GEOSGeometry* ring(const Box& box) const;
  GEOSContextHandle_t context() const { return context_; }

 private:
  GEOSContextHandle_t context_;
  std::string error_;
};

using Triangle = std::array<glm::vec3, 3>;

/// The constrained Delaunay triangles of a polygon or several, at height 0, each counter-clockwise from the corner of least
/// (x, y). GEOS promises no order of them.
std::vector<Triangle> triangulate(const Geos& geos, const GEOSGeometry& polygons);

/// Which triangles share an edge, corner for corner.
std::vector<std::vector<std::uint32_t>> edge_neighbours(std::span<const Triangle> triangles);

}  // namespace vismat
