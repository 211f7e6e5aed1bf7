// GEOS by its C interface, the one that stays stable between versions.
#pragma once
#include <geos_c.h>

#include <glm/vec2.hpp>
#include <memory>
#include <span>
#include <string>

namespace vismat {

/// A context of GEOS, for one thread; what it owns is freed.
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
  GEOSContextHandle_t context() const { return context_; }

 private:
  GEOSContextHandle_t context_;
  std::string error_;
};

}  // namespace vismat
