#include "visibility/cells/ground_triangles.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <map>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>

#include "visibility/geometry/geos.h"
#include "visibility/geometry/plane_geometry.h"

namespace vismat {
namespace {

GEOSGeometry* ring(const Geos& geos, const Box& box) {
  const auto &low = box.low, &high = box.high;
  return geos.ring(std::array<glm::dvec2, 4>{
      {{low[0], low[1]}, {high[0], low[1]}, {high[0], high[1]}, {low[0], high[1]}}});
}

/// The constrained Delaunay triangles of a polygon or several.
std::vector<Triangle> delaunay(const Geos& geos, const GEOSGeometry& polygons) {
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

/// Fewer polygons, counter-clockwise, that cover the same: none twice, and rectangles along an axis joined end to end. Walls
/// come as many of those, and their union by GEOS is most of the work.
std::vector<Polygon> fewer(std::vector<Polygon> polygons) {
  std::vector<std::array<double, 4>> rectangles;  // low and high across, low and high along
  std::vector<Polygon> others;
  for (Polygon& polygon : polygons) {
    for (glm::dvec2& corner : polygon) corner = glm::round(corner / plan_grid) * plan_grid;
    polygon = hull_in_plan(std::move(polygon));  // from its least corner on, so equal ones are equal
    if (polygon.size() < 3) continue;
    const glm::dvec2 &low = polygon[0], &high = polygon[2];
    if (polygon.size() == 4 && polygon[1] == glm::dvec2(high.x, low.y) &&
        polygon[3] == glm::dvec2(low.x, high.y)) {
      rectangles.push_back({low.x, high.x, low.y, high.y});
    } else {
      others.push_back(std::move(polygon));
    }
  }
  for (int axis = 0; axis < 2; ++axis) {
    std::sort(rectangles.begin(), rectangles.end());
    std::vector<std::array<double, 4>> longer;
    for (const auto& r : rectangles) {
      if (!longer.empty() && longer.back()[0] == r[0] && longer.back()[1] == r[1] &&
          r[2] <= longer.back()[3]) {
        longer.back()[3] = std::max(longer.back()[3], r[3]);
      } else {
        longer.push_back(r);
      }
    }
    rectangles.clear();
    for (const auto& r : longer) rectangles.push_back({r[2], r[3], r[0], r[1]});
  }
  const auto before = [](const Polygon& p, const Polygon& q) {
    return std::lexicographical_compare(
        p.begin(), p.end(), q.begin(), q.end(),
        [](const auto& a, const auto& b) { return std::tie(a.x, a.y) < std::tie(b.x, b.y); });
  };
  std::sort(others.begin(), others.end(), before);
  others.erase(std::unique(others.begin(), others.end()), others.end());
  for (const auto& r : rectangles) others.push_back({{r[0], r[2]}, {r[1], r[2]}, {r[1], r[3]}, {r[0], r[3]}});
  return others;
}

/// One polygon or several from convex polygons that may overlap. Not GEOS's own rounding to a grid: it made half of the time,
/// a third alone by seeding random numbers for every operation.
Geos::Geometry joined(const Geos& geos, std::vector<Polygon> polygons) {
  std::vector<GEOSGeometry*> parts;
  for (const Polygon& polygon : fewer(std::move(polygons))) {
    parts.push_back(GEOSGeom_createPolygon_r(geos.context(), geos.ring(polygon), nullptr, 0));
  }
  const auto all = geos.own(GEOSGeom_createCollection_r(geos.context(), GEOS_MULTIPOLYGON, parts.data(),
                                                        static_cast<unsigned>(parts.size())));
  return geos.own(GEOSUnaryUnion_r(geos.context(), all.get()));
}

/// Adds the triangles of polygons, which are halved where there are many holes (GEOS joins them in quadratic time) or where
/// GEOS fails: before 3.12 it does, or leaves parts out, where a hole touches the outline in a point.
void triangulate_in_parts(const Geos& geos, const GEOSGeometry& polygons, std::vector<Triangle>& triangles) {
  constexpr int most_holes = 64;
  const GEOSContextHandle_t context = geos.context();
  for (int i = 0; i < GEOSGetNumGeometries_r(context, &polygons); ++i) {
    const GEOSGeometry* polygon = GEOSGetGeometryN_r(context, &polygons, i);
    std::array<double, 2> low{}, high{};
    double area = 0;
    GEOSArea_r(context, polygon, &area);
    if (!(area > plan_grid * plan_grid)) continue;  // lines and points have none
    if (GEOSGetNumInteriorRings_r(context, polygon) <= most_holes) {
      try {
        const std::vector<Triangle> all = delaunay(geos, *polygon);
        double covered = 0;
        for (const Triangle& t : all) covered += area_in_plan({t[0], t[1], t[2]});
        if (std::abs(covered - area) <= 1e-3 * area + plan_grid) {
          triangles.insert(triangles.end(), all.begin(), all.end());
          continue;
        }
      } catch (const std::runtime_error&) {
      }
    }
    GEOSGeom_getXMin_r(context, polygon, &low[0]);
    GEOSGeom_getXMax_r(context, polygon, &high[0]);
    GEOSGeom_getYMin_r(context, polygon, &low[1]);
    GEOSGeom_getYMax_r(context, polygon, &high[1]);
    const std::size_t axis = high[0] - low[0] >= high[1] - low[1] ? 0 : 1;
    if (high[axis] - low[axis] < 8 * plan_grid) continue;  // nobody stands there
    const double middle = std::round((low[axis] + high[axis]) / 2 / plan_grid) * plan_grid;
    for (const bool upper : {false, true}) {
      auto from = low, to = high;
      (upper ? from : to)[axis] = middle;
      const auto half = geos.own(GEOSGeom_createPolygon_r(
          context,
          geos.ring(std::array<glm::dvec2, 4>{
              {{from[0], from[1]}, {to[0], from[1]}, {to[0], to[1]}, {from[0], to[1]}}}),
          nullptr, 0));
      triangulate_in_parts(geos, *geos.own(GEOSIntersection_r(context, polygon, half.get())), triangles);
    }
  }
}

}  // namespace

Polygon hull_in_plan(Polygon points) {
  return convex_hull(std::move(points),
                     [](const auto& a, const auto& b, const auto& c) { return cross(b - a, c - b); });
}

double area_in_plan(const std::array<glm::dvec3, 3>& triangle) {
  return 0.5 * std::abs(cross(glm::dvec2(triangle[1] - triangle[0]), glm::dvec2(triangle[2] - triangle[0])));
}

std::vector<Triangle> triangulate(const GroundPlan& plan, double tolerance) {
  const Geos geos;
  Geos::Geometry left = joined(geos, plan.ground);
  if (!plan.obstacles.empty()) {
    const auto in_the_way = geos.own(
        GEOSTopologyPreserveSimplify_r(geos.context(), joined(geos, plan.obstacles).get(), tolerance));
    left = geos.own(GEOSDifference_r(geos.context(), left.get(), in_the_way.get()));
  }
  if (!plan.steps.empty()) {
    left = geos.own(GEOSDifference_r(geos.context(), left.get(), joined(geos, plan.steps).get()));
  }
  std::vector<Triangle> triangles;
  triangulate_in_parts(geos, *left, triangles);
  return triangles;
}

std::vector<Triangle> triangulate_around(const Box& ground, std::span<const Box> holes) {
  const Geos geos;
  std::vector<GEOSGeometry*> rings;
  for (const Box& hole : holes) rings.push_back(ring(geos, hole));
  return delaunay(geos, *geos.own(GEOSGeom_createPolygon_r(geos.context(), ring(geos, ground), rings.data(),
                                                           static_cast<unsigned>(rings.size()))));
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
