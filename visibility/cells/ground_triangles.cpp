#include "visibility/cells/ground_triangles.h"

#include <algorithm>
#include <map>
#include <stdexcept>
#include <tuple>
#include <utility>

namespace vismat {

Geos::Geos() : context_(GEOS_init_r()) {
  GEOSContext_setErrorMessageHandler_r(
      context_, [](const char* message, void* self) { static_cast<Geos*>(self)->error_ = message; }, this);
}

Geos::~Geos() {
  GEOS_finish_r(context_);
}

Geos::Geometry Geos::own(GEOSGeometry* geometry) const {
  if (geometry == nullptr) throw std::runtime_error("ground: GEOS: " + error_);
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

GEOSGeometry* Geos::ring(const Box& box) const {
  const auto &low = box.low, &high = box.high;
  return ring(std::array<glm::dvec2, 4>{
      {{low[0], low[1]}, {high[0], low[1]}, {high[0], high[1]}, {low[0], high[1]}}});
}

std::vector<Triangle> triangulate(const Geos& geos, const GEOSGeometry& polygons) {
  const GEOSContextHandle_t context = geos.context();
  const auto pieces = geos.own(GEOSConstrainedDelaunayTriangulation_r(context, &polygons));
  std::vector<Triangle> triangles(static_cast<std::size_t>(GEOSGetNumGeometries_r(context, pieces.get())));
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const GEOSGeometry* piece = GEOSGetGeometryN_r(context, pieces.get(), static_cast<int>(i));
    const GEOSCoordSequence* points = GEOSGeom_getCoordSeq_r(context, GEOSGetExteriorRing_r(context, piece));
    Triangle& t = triangles[i];
    for (unsigned corner = 0; corner < 3; ++corner) {
      double x = 0, y = 0;
      GEOSCoordSeq_getXY_r(context, points, corner, &x, &y);
      t[corner] = {static_cast<float>(x), static_cast<float>(y), 0.0f};
    }
    if ((t[1].x - t[0].x) * (t[2].y - t[0].y) < (t[1].y - t[0].y) * (t[2].x - t[0].x)) std::swap(t[1], t[2]);
    const auto before = [](const glm::vec3& a, const glm::vec3& b) {
      return std::tie(a.x, a.y) < std::tie(b.x, b.y);
    };
    std::rotate(t.begin(), std::min_element(t.begin(), t.end(), before), t.end());
  }
  return triangles;
}

std::vector<std::vector<std::uint32_t>> edge_neighbours(std::span<const Triangle> triangles) {
  std::vector<std::vector<std::uint32_t>> rows(triangles.size());
  std::map<std::array<float, 6>, std::uint32_t> open;  // directed edges that still wait for their other side
  for (std::uint32_t i = 0; i < triangles.size(); ++i) {
    for (unsigned side = 0; side < 3; ++side) {
      const glm::vec3 a = triangles[i][side], b = triangles[i][(side + 1) % 3];
      if (const auto other = open.find({b.x, b.y, b.z, a.x, a.y, a.z}); other != open.end()) {
        rows[i].push_back(other->second);
        rows[other->second].push_back(i);
        open.erase(other);
      } else {
        open.emplace(std::array{a.x, a.y, a.z, b.x, b.y, b.z}, i);
      }
    }
  }
  for (auto& row : rows) std::sort(row.begin(), row.end());
  return rows;
}

}  // namespace vismat
