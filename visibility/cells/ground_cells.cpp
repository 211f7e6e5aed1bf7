// ALGORITHM. Each piece of ground (level triangles of one height that meet, or one sloping triangle) is a polygon in the plan. Whatever
// of the scene lies within a viewer's height above it is clipped to that band, laid into the plan, grown by the radius and
// taken away; a wall, which has no area in the plan, becomes a strip, so that inside and outside of a closed building fall
// apart and nothing need be known of which side of a triangle is solid. What rises no higher than a step and is walkable is
// taken away without growing: a viewer stands on it instead. The rest is triangulated (constrained Delaunay). Pieces join
// where their edges overlap in the plan, no more than a step apart; walking over such edges from the start finds what is kept.
// Obstacles grow to the convex hull of squares at their corners, which keeps right angles: round ones cost many triangles.
#include "visibility/cells/ground_cells.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>
#include <span>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>

#include "matrix/base/parallel.h"
#include "matrix/base/z_order.h"
#include "visibility/cells/ground_triangles.h"
#include "visibility/rays/ray_caster.h"

namespace vismat {
namespace {

constexpr double grid =
    1e-3;  // metres; corners in the plan are rounded to it, and thinner triangles left out

[[noreturn]] void refuse(const std::string& what) {
  throw std::invalid_argument("ground cells: " + what);
}

using Corners = std::array<glm::dvec3, 3>;

struct Plane {  // z = at.z + slope.(xy - at.xy)
  glm::dvec3 at{};
  glm::dvec2 slope{};
  double height(double x, double y) const { return at.z + slope.x * (x - at.x) + slope.y * (y - at.y); }
};

/// Ground of one slope and height.
struct Piece {
  Plane plane;
  std::vector<std::uint32_t> triangles;  // of the scene
  Box bounds;
};

struct Surface {
  const Scene& scene;
  std::vector<std::uint8_t> walkable;  // of triangles
  Corners corners(std::uint32_t triangle) const {
    Corners corners;
    for (std::size_t i = 0; i < 3; ++i) {
      corners[i] = scene.vertices[scene.indices[std::size_t{3} * triangle + i]];
    }
    return corners;
  }
};

Box bounds_of(const Corners& corners) {
  Box box;
  for (int axis = 0; axis < 3; ++axis) {
    const auto [low, high] = std::minmax({corners[0][axis], corners[1][axis], corners[2][axis]});
    box.low[static_cast<unsigned>(axis)] = static_cast<float>(low);
    box.high[static_cast<unsigned>(axis)] = static_cast<float>(high);
  }
  return box;
}

/// Triangles by where they are in the plan, in square bins.
class Bins {
 public:
  Bins(const std::vector<Box>& boxes, const Box& region) : boxes_(boxes), low_{region.low[0], region.low[1]} {
    const double extent = std::max({region.high[0] - region.low[0], region.high[1] - region.low[1], 1e-3f});
    side_ = extent / std::clamp(std::sqrt(static_cast<double>(boxes.size())), 1.0, 2000.0);
    for (;; side_ *= 2) {  // large triangles lie in many bins; not more than eight each on average
      count_ = static_cast<std::uint32_t>(extent / side_) + 1;
      std::uint64_t entries = 0;
      for (const Box& box : boxes) {
        const Range r = range(box);
        entries += std::uint64_t{r.to[0] - r.from[0] + 1} * (r.to[1] - r.from[1] + 1);
      }
      if (entries <= 8 * boxes.size() + 1000 || count_ == 1) break;
    }
    bins_.resize(std::size_t{count_} * count_);
    for (std::uint32_t i = 0; i < boxes.size(); ++i) {
      const Range r = range(boxes[i]);
      for (std::uint32_t y = r.from[1]; y <= r.to[1]; ++y) {
        for (std::uint32_t x = r.from[0]; x <= r.to[0]; ++x) bins_[std::size_t{y} * count_ + x].push_back(i);
      }
    }
  }

  /// Those whose boxes meet the box, ascending.
  std::vector<std::uint32_t> meeting(const Box& box) const {
    std::vector<std::uint32_t> found;
    const Range r = range(box);
    for (std::uint32_t y = r.from[1]; y <= r.to[1]; ++y) {
      for (std::uint32_t x = r.from[0]; x <= r.to[0]; ++x) {
        for (const std::uint32_t i : bins_[std::size_t{y} * count_ + x]) {
          bool apart = false;
          for (unsigned axis = 0; axis < 3; ++axis) {
            apart |= boxes_[i].low[axis] > box.high[axis] || boxes_[i].high[axis] < box.low[axis];
          }
          if (!apart) found.push_back(i);
        }
      }
    }
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
    return found;
  }

 private:
  struct Range {
    std::array<std::uint32_t, 2> from, to;
  };
  Range range(const Box& box) const {
    const auto bin = [&](double x, unsigned axis) {
      return static_cast<std::uint32_t>(std::clamp((x - low_[axis]) / side_, 0.0, count_ - 1.0));
    };
    return {{bin(box.low[0], 0), bin(box.low[1], 1)}, {bin(box.high[0], 0), bin(box.high[1], 1)}};
  }

  const std::vector<Box>& boxes_;
  std::array<double, 2> low_;
  double side_ = 0;
  std::uint32_t count_ = 0;
  std::vector<std::vector<std::uint32_t>> bins_;
};

/// The part of the triangle between two heights above the plane, as a convex polygon in the plan.
std::vector<glm::dvec2> within_band(const Corners& triangle, const Plane& plane, double low, double high) {
  std::vector<glm::dvec3> polygon;  // z: above the plane
  for (const glm::dvec3& c : triangle) polygon.emplace_back(c.x, c.y, c.z - plane.height(c.x, c.y));
  for (const double sign : {1.0, -1.0}) {
    const double bound = sign > 0 ? low : -high;
    std::vector<glm::dvec3> kept;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const glm::dvec3 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
      const double above_a = sign * a.z - bound, above_b = sign * b.z - bound;
      if (above_a >= 0) kept.push_back(a);
      if ((above_a > 0 && above_b < 0) || (above_a < 0 && above_b > 0)) {
        kept.push_back(a + (b - a) * (above_a / (above_a - above_b)));
      }
    }
    polygon = std::move(kept);
  }
  std::vector<glm::dvec2> plan;
  for (const glm::dvec3& c : polygon) plan.emplace_back(c.x, c.y);
  return plan;
}

double cross(const glm::dvec2& a, const glm::dvec2& b) {
  return a.x * b.y - a.y * b.x;
}

/// Counter-clockwise; fewer than three corners where there is no area.
std::vector<glm::dvec2> convex_hull(std::vector<glm::dvec2> points) {
  if (points.empty()) return points;
  const auto before = [](const glm::dvec2& a, const glm::dvec2& b) {
    return std::tie(a.x, a.y) < std::tie(b.x, b.y);
  };
  std::sort(points.begin(), points.end(), before);
  std::vector<glm::dvec2> hull;
  for (int half = 0; half < 2; ++half) {
    const std::size_t first = hull.size();
    for (const glm::dvec2& p : points) {
      while (hull.size() >= first + 2 && cross(hull.back() - hull[hull.size() - 2], p - hull.back()) <= 0)
        hull.pop_back();
      hull.push_back(p);
    }
    hull.pop_back();
    std::reverse(points.begin(), points.end());
  }
  return hull;
}

std::vector<glm::dvec2> grown(const std::vector<glm::dvec2>& polygon, double radius) {
  std::vector<glm::dvec2> corners;
  for (const glm::dvec2& c : polygon) {
    for (const double x : {-radius, radius})
      for (const double y : {-radius, radius}) corners.push_back(c + glm::dvec2(x, y));
  }
  return convex_hull(std::move(corners));
}

double area_of(const Corners& corners) {
  return 0.5 * std::abs(cross(glm::dvec2(corners[1] - corners[0]), glm::dvec2(corners[2] - corners[0])));
}

using Polygon = std::vector<glm::dvec2>;

/// Fewer polygons, counter-clockwise, that cover the same: none twice, and rectangles along an axis joined end to end. Walls
/// come as many of those, and their union by GEOS is most of the work.
std::vector<Polygon> fewer(std::vector<Polygon> polygons) {
  std::vector<std::array<double, 4>> rectangles;  // low and high across, low and high along
  std::vector<Polygon> others;
  for (Polygon& polygon : polygons) {
    for (glm::dvec2& corner : polygon) corner = glm::round(corner / grid) * grid;
    polygon = convex_hull(std::move(polygon));  // from its least corner on, so equal ones are equal
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
    if (!(area > grid * grid)) continue;  // lines and points have none
    if (GEOSGetNumInteriorRings_r(context, polygon) <= most_holes) {
      try {
        const std::vector<Triangle> all = triangulate(geos, *polygon);
        double covered = 0;
        for (const Triangle& t : all) covered += area_of({t[0], t[1], t[2]});
        if (std::abs(covered - area) <= 1e-3 * area + grid) {
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
    if (high[axis] - low[axis] < 8 * grid) continue;  // nobody stands there
    const double middle = std::round((low[axis] + high[axis]) / 2 / grid) * grid;
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

/// What is left of a piece, at its height.
std::vector<Triangle> free_of_obstacles(const Surface& surface, const Bins& bins, const Piece& piece,
                                        const GroundCellsOptions& options) {
  const Geos geos;
  const double low = 1e-3, high = double{(*options.viewers.eyes)[1]} + options.radius;
  std::vector<Polygon> ground, obstacles, steps;
  for (const std::uint32_t triangle : piece.triangles) {
    std::vector<glm::dvec2> plan;
    for (const glm::dvec3& c : surface.corners(triangle)) plan.emplace_back(c.x, c.y);
    ground.push_back(convex_hull(std::move(plan)));
    if (ground.back().size() < 3) ground.pop_back();
  }
  if (piece.triangles.empty()) {  // a plane over the region
    const Box& b = piece.bounds;
    ground.push_back(
        {{b.low[0], b.low[1]}, {b.high[0], b.low[1]}, {b.high[0], b.high[1]}, {b.low[0], b.high[1]}});
  }
  Box around = piece.bounds;
  for (unsigned axis = 0; axis < 2; ++axis) {
    around.low[axis] -= options.radius;
    around.high[axis] += options.radius;
  }
  around.high[2] += static_cast<float>(high);
  for (const std::uint32_t triangle : bins.meeting(around)) {
    const Corners corners = surface.corners(triangle);
    if (surface.walkable[triangle]) {
      auto step = convex_hull(within_band(corners, piece.plane, low, options.step));
      if (step.size() >= 3) steps.push_back(std::move(step));
    }
    const auto obstacle = within_band(corners, piece.plane, options.step, high);
    if (!obstacle.empty()) obstacles.push_back(grown(obstacle, options.radius));
  }
  Geos::Geometry left = joined(geos, ground);
  if (!obstacles.empty()) {
    // A flat wall of many triangles leaves corners on straight edges; a quarter of the radius is given away for fewer.
    const auto in_the_way = geos.own(
        GEOSTopologyPreserveSimplify_r(geos.context(), joined(geos, obstacles).get(), options.radius / 4));
    left = geos.own(GEOSDifference_r(geos.context(), left.get(), in_the_way.get()));
  }
  if (!steps.empty()) {
    left = geos.own(GEOSDifference_r(geos.context(), left.get(), joined(geos, steps).get()));
  }
  std::vector<Triangle> triangles;
  triangulate_in_parts(geos, *left, triangles);
  for (Triangle& t : triangles) {
    for (glm::vec3& corner : t) corner.z = static_cast<float>(piece.plane.height(corner.x, corner.y));
  }
  std::erase_if(triangles, [](const Triangle& t) {
    const glm::dvec2 a(t[0]), b(t[1]), c(t[2]);
    const double longest = std::max({glm::distance(a, b), glm::distance(b, c), glm::distance(c, a)});
    return !(cross(b - a, c - a) > grid * longest);
  });
  return triangles;
}

/// Triangles in groups, so that boxes of different groups do not meet in the plan.
std::vector<std::vector<std::uint32_t>> touching_in_plan(std::vector<std::uint32_t>& triangles,
                                                         const std::vector<Box>& boxes) {
  std::sort(triangles.begin(), triangles.end(), [&](std::uint32_t a, std::uint32_t b) {
    return std::pair(boxes[a].low[0], a) < std::pair(boxes[b].low[0], b);
  });
  std::vector<std::size_t> group(
      triangles.size());  // a member of the same group, the group's first in the end
  std::iota(group.begin(), group.end(), std::size_t{0});
  const auto first = [&](std::size_t i) {
    while (group[i] != i) i = group[i] = group[group[i]];
    return i;
  };
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const Box& a = boxes[triangles[i]];
    for (std::size_t j = i + 1; j < triangles.size() && boxes[triangles[j]].low[0] <= a.high[0]; ++j) {
      const Box& b = boxes[triangles[j]];
      if (a.low[1] > b.high[1] || b.low[1] > a.high[1]) continue;
      const auto [low, high] = std::minmax({first(i), first(j)});
      group[high] = low;
    }
  }
  std::vector<std::vector<std::uint32_t>> groups(triangles.size());
  for (std::size_t i = 0; i < triangles.size(); ++i) groups[first(i)].push_back(triangles[i]);
  std::erase_if(groups, [](const auto& some) { return some.empty(); });
  return groups;
}

std::vector<Piece> pieces_of(const Surface& surface, const std::vector<Box>& boxes, const Box& region,
                             const GroundCellsOptions& options) {
  std::vector<Piece> pieces;
  if (options.height) {
    Piece& plane = pieces.emplace_back();
    plane.plane.at.z = *options.height;
    plane.bounds = region;
    plane.bounds.low[2] = plane.bounds.high[2] = *options.height;
    return pieces;
  }
  std::map<float, std::vector<std::uint32_t>> of_height;  // level triangles, for joining
  const auto add_piece = [&](std::span<const std::uint32_t> triangles, const glm::dvec2& slope) {
    Piece& piece = pieces.emplace_back();
    piece.plane = {surface.corners(triangles[0])[0], slope};
    piece.triangles.assign(triangles.begin(), triangles.end());
    piece.bounds = boxes[triangles[0]];
    for (const std::uint32_t triangle : triangles) {
      for (unsigned axis = 0; axis < 2; ++axis) {
        piece.bounds.low[axis] = std::min(piece.bounds.low[axis], boxes[triangle].low[axis]);
        piece.bounds.high[axis] = std::max(piece.bounds.high[axis], boxes[triangle].high[axis]);
      }
    }
  };
  for (std::uint32_t triangle = 0; triangle < boxes.size(); ++triangle) {
    const Box& box = boxes[triangle];
    if (!surface.walkable[triangle]) continue;
    bool inside = true;
    for (unsigned axis = 0; axis < 3; ++axis) {
      inside &= box.low[axis] >= region.low[axis] && box.high[axis] <= region.high[axis];
    }
    if (!inside) continue;
    if (box.low[2] == box.high[2]) {
      of_height[box.low[2]].push_back(triangle);
    } else {
      const Corners c = surface.corners(triangle);
      const glm::dvec3 normal = glm::cross(c[1] - c[0], c[2] - c[0]);
      add_piece(std::span(&triangle, 1), glm::dvec2(-normal.x, -normal.y) / normal.z);
    }
  }
  for (auto& [height, triangles] : of_height) {
    for (const auto& together : touching_in_plan(triangles, boxes)) add_piece(together, {});
  }
  std::erase_if(pieces, [&](const Piece& piece) {
    double area = 0;
    for (const std::uint32_t triangle : piece.triangles) area += area_of(surface.corners(triangle));
    return area < options.smallest;
  });
  return pieces;
}

/// Neighbours over parts of edges too, and over steps.
std::vector<std::vector<std::uint32_t>> walkable_neighbours(const std::vector<Triangle>& triangles,
                                                            double step) {
  std::vector<std::vector<std::uint32_t>> rows = edge_neighbours(triangles);
  struct Edge {
    glm::dvec3 a, b;
    std::uint32_t triangle;
    double low, high;  // along x
  };
  std::vector<Edge> edges;
  for (std::uint32_t i = 0; i < triangles.size(); ++i) {
    for (unsigned side = 0; side < 3; ++side) {
      const glm::vec3 a = triangles[i][side], b = triangles[i][(side + 1) % 3];
      const bool shared = std::any_of(rows[i].begin(), rows[i].end(), [&](std::uint32_t other) {
        const Triangle& t = triangles[other];
        return std::count(t.begin(), t.end(), a) == 1 && std::count(t.begin(), t.end(), b) == 1;
      });
      if (!shared) edges.push_back({a, b, i, std::min(a.x, b.x) - 2 * grid, std::max(a.x, b.x) + 2 * grid});
    }
  }
  std::stable_sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) { return a.low < b.low; });
  const auto meet = [&](const Edge& e, const Edge& f) {
    const glm::dvec2 from(e.a), along = glm::dvec2(e.b) - from;
    const double length = glm::length(along);
    if (!(length > 0)) return false;
    const glm::dvec2 unit = along / length;
    const auto place = [&](const glm::dvec3& p) {
      return glm::dvec2(glm::dot(unit, glm::dvec2(p) - from), cross(unit, glm::dvec2(p) - from));
    };
    const glm::dvec2 c = place(f.a), d = place(f.b);
    if (!(d.x < c.x) || std::abs(c.y) > 2 * grid || std::abs(d.y) > 2 * grid) return false;
    const double begin = std::max(0.0, d.x), end = std::min(length, c.x);
    if (end - begin < 10 * grid) return false;
    const double middle = (begin + end) / 2;
    const double height_e = e.a.z + (e.b.z - e.a.z) * middle / length;
    const double height_f = f.a.z + (f.b.z - f.a.z) * (c.x - middle) / (c.x - d.x);
    return std::abs(height_e - height_f) <= step;
  };
  for (std::size_t i = 0; i < edges.size(); ++i) {
    for (std::size_t j = i + 1; j < edges.size() && edges[j].low <= edges[i].high; ++j) {
      const std::uint32_t a = edges[i].triangle, b = edges[j].triangle;
      if (a == b || !meet(edges[i], edges[j])) continue;
      rows[a].push_back(b);
      rows[b].push_back(a);
    }
  }
  for (auto& row : rows) {
    std::sort(row.begin(), row.end());
    row.erase(std::unique(row.begin(), row.end()), row.end());
  }
  return rows;
}

/// The triangle on which one stands who falls from the point; none: its number is that of all triangles.
std::size_t below(const std::vector<Triangle>& triangles, const glm::vec3& point) {
  std::size_t best = triangles.size();
  double highest = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const Triangle& t = triangles[i];
    const glm::dvec2 p(point);
    std::array<double, 3> weight;
    for (unsigned side = 0; side < 3; ++side) {
      const glm::dvec2 a(t[(side + 1) % 3]), b(t[(side + 2) % 3]);
      weight[side] = cross(b - a, p - a);
    }
    if (*std::min_element(weight.begin(), weight.end()) < 0) continue;
    const double sum = weight[0] + weight[1] + weight[2];
    const double height = (weight[0] * t[0].z + weight[1] * t[1].z + weight[2] * t[2].z) / sum;
    if (height <= point.z && height > highest) highest = height, best = i;
  }
  return best;
}

/// Marks what can be walked to.
std::vector<std::uint8_t> walk(const Scene& scene, const std::vector<Triangle>& triangles,
                               const std::vector<std::vector<std::uint32_t>>& neighbours,
                               const GroundCellsOptions& options) {
  const auto none = static_cast<std::uint32_t>(triangles.size());
  std::vector<std::uint32_t> part(triangles.size(), none);  // connected ground, by its first triangle
  for (std::uint32_t first = 0; first < none; ++first) {
    std::vector<std::uint32_t> open;
    if (part[first] == none) open = {first}, part[first] = first;
    while (!open.empty()) {
      const std::uint32_t at = open.back();
      open.pop_back();
      for (const std::uint32_t next : neighbours[at]) {
        if (part[next] == none) part[next] = first, open.push_back(next);
      }
    }
  }
  std::vector<std::uint8_t> start(triangles.size());  // of parts
  for (const glm::vec3& from : options.viewers.from) {
    const std::size_t triangle = below(triangles, from);
    if (triangle == triangles.size()) {
      refuse("no ground that one can stand on below the start (" + std::to_string(from.x) + ", " +
             std::to_string(from.y) + ", " + std::to_string(from.z) + ")");
    }
    start[part[triangle]] = 1;
  }
  if (options.viewers.from.empty()) {
    const RayCaster caster(scene);
    std::vector<double> area(triangles.size());
    std::vector<std::uint8_t> under_sky(triangles.size());
    for (std::size_t i = 0; i < triangles.size(); ++i) {
      const Triangle& t = triangles[i];
      area[part[i]] += area_of({t[0], t[1], t[2]});
      if (under_sky[part[i]]) continue;
      glm::vec3 eye = (t[0] + t[1] + t[2]) / 3.0f;
      eye.z += (*options.viewers.eyes)[0];
      under_sky[part[i]] = caster.hit(eye, {0, 0, 1}).triangle == Hit::nothing;
    }
    std::uint32_t best = 0;
    for (std::uint32_t i = 1; i < none; ++i) {
      if (std::pair(under_sky[i], area[i]) > std::pair(under_sky[best], area[best])) best = i;
    }
    start[best] = 1;
  }
  std::vector<std::uint8_t> reached(triangles.size());
  for (std::size_t i = 0; i < triangles.size(); ++i) reached[i] = start[part[i]];
  return reached;
}

void check(const GroundCellsOptions& o) {
  if (!(o.steepest >= 0 && o.steepest < 89)) refuse("the steepest slope must lie between 0 and 89 degrees");
  if (!(o.step > 0.01f && o.step <= 100)) refuse("a step must be 0.01 to 100 m high");
  if (!(o.radius >= 0.01f && o.radius <= 100)) refuse("the radius must lie between 0.01 and 100 m");
  if (!(o.smallest >= 0)) refuse("the smallest area must not be below 0");
  if (!o.viewers.eyes) refuse("viewers on the ground need eye heights");
  const auto [low, high] = *o.viewers.eyes;
  if (!(low >= o.step && low <= high && high <= 1000)) {
    refuse("eyes must be at least a step and at most 1000 m above the ground, the lower height first");
  }
  if (o.height && !(std::abs(*o.height) <= 1e9f)) refuse("the ground's height must lie within 1e9 m");
}

}  // namespace

ViewCells make_ground_cells(const Scene& scene, const GroundCellsOptions& options) {
  check(options);
  const Box region = options.region ? *options.region : bounds_of(scene);
  const auto count = static_cast<std::uint32_t>(scene.indices.size() / 3);
  Surface surface{scene, std::vector<std::uint8_t>(count)};
  std::vector<Box> boxes(count);
  const double upright = std::cos(options.steepest * std::numbers::pi / 180);
  for (std::uint32_t triangle = 0; triangle < count; ++triangle) {
    const Corners c = surface.corners(triangle);
    const glm::dvec3 normal = glm::cross(c[1] - c[0], c[2] - c[0]);
    boxes[triangle] = bounds_of(c);
    surface.walkable[triangle] =
        std::abs(normal.z) > 0 && std::abs(normal.z) >= upright * glm::length(normal);
  }
  const Bins bins(boxes, region);
  const std::vector<Piece> pieces = pieces_of(surface, boxes, region, options);
  std::vector<std::vector<Triangle>> of_piece(pieces.size());
  parallel_for(pieces.size(), options.threads,
               [&](std::uint64_t i) { of_piece[i] = free_of_obstacles(surface, bins, pieces[i], options); });
  std::vector<Triangle> triangles;
  for (const auto& some : of_piece) triangles.insert(triangles.end(), some.begin(), some.end());
  if (triangles.empty())
    refuse("no ground in the region that one can stand on; give a height, or a larger region");

  const double side = std::max({region.high[0] - region.low[0], region.high[1] - region.low[1], 1e-3f});
  const auto key = [&](const Triangle& t) {
    const glm::vec3 centroid = (t[0] + t[1] + t[2]) / 3.0f;
    const auto square = [&](double x) {
      return static_cast<std::uint32_t>(std::clamp(x / side, 0.0, 1.0) * 4095);
    };
    return std::tuple(
        z_order(square(double{centroid.x} - region.low[0]), square(double{centroid.y} - region.low[1])),
        centroid.z, centroid.x, centroid.y);
  };
  std::sort(triangles.begin(), triangles.end(),
            [&](const Triangle& a, const Triangle& b) { return key(a) < key(b); });
  const auto neighbours = walkable_neighbours(triangles, options.step);
  const std::vector<std::uint8_t> reached = walk(scene, triangles, neighbours, options);

  ViewCells cells;
  cells.eye_low = (*options.viewers.eyes)[0];
  cells.eye_high = (*options.viewers.eyes)[1];
  std::vector<std::uint32_t> kept(triangles.size());  // the cell of each triangle
  std::inclusive_scan(reached.begin(), reached.end(), kept.begin(), std::plus<>(), 0u);
  std::vector<std::vector<std::uint32_t>> rows;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    if (!reached[i]) continue;
    cells.corners.insert(cells.corners.end(), triangles[i].begin(), triangles[i].end());
    rows.push_back(neighbours[i]);
    for (std::uint32_t& other : rows.back()) other = kept[other] - 1;
  }
  cells.neighbours = VisibilityMatrix::from_rows(rows, static_cast<std::uint32_t>(rows.size()));
  return cells;
}

}  // namespace vismat
