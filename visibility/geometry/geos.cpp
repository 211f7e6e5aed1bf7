#include "visibility/geometry/geos.h"

#include <stdexcept>

namespace vismat {

Geos::Geos() : context_(GEOS_init_r()) {
  GEOSContext_setErrorMessageHandler_r(
      context_, [](const char* message, void* self) { static_cast<Geos*>(self)->error_ = message; }, this);
}

Geos::~Geos() {
  GEOS_finish_r(context_);
}

Geos::Geometry Geos::own(GEOSGeometry* geometry) const {
  if (geometry == nullptr) throw std::runtime_error("GEOS: " + error_);
  return {geometry, Delete{context_}};
}

GEOSGeometry* Geos::ring(std::span<const glm::dvec2> corners) const {
  const auto count = static_cast<unsigned>(corners.size());
  GEOSCoordSequence* points = GEOSCoordSeq_create_r(context_, count + 1, 2);
  for (unsigned i = 0; i <= count; ++i) {
    GEOSCoordSeq_setXY_r(context_, points, i, corners[i % count].x, corners[i % count].y);
  }
  return GEOSGeom_createLinearRing_r(context_, points);
}

}  // namespace vismat
