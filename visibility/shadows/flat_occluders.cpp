// ALGORITHM. The convex hull of a face's outline if the face fills it, else inner rectangles: the inner boxes of the face swept a
// little along its normal.
// Single triangles as occluders were tried: they hide a quarter of what whole walls do.
#include "visibility/shadows/flat_occluders.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include "visibility/geometry/plane_geometry.h"
#include "visibility/geometry/point_bounds.h"
#include "visibility/shadows/inner_boxes.h"

namespace vismat {
namespace {

using glm::dvec3;
using Triangle = std::array<std::uint32_t, 3>;

/// A convex polygon in a face, and how far all of the face's outline stays away from it but for what stands on the ground.
struct Piece {
  std::vector<dvec3> corners;  // in the plane, counter-clockwise about its normal
  double area = 0, inset = 0;
};

/// Twice the area of a triangle in the xy plane; above 0 where o, a, b turn left.
double turned_left(const dvec3& o, const dvec3& a, const dvec3& b) {
  return (a.x - o.x) * (b.y - o.y) - (a.y - o.y) * (b.x - o.x);
}

/// A hull without corners that stand out by less than `tolerance`.
std::vector<dvec3> without_flat_corners(std::vector<dvec3> hull, double tolerance) {
  for (std::size_t i = 0; i < hull.size() && hull.size() > 3;) {
    const dvec3 &before = hull[(i + hull.size() - 1) % hull.size()], &after = hull[(i + 1) % hull.size()];
    if (turned_left(before, hull[i], after) <= tolerance * glm::length(after - before)) {
      hull.erase(hull.begin() + static_cast<std::ptrdiff_t>(i));
    } else {
      ++i;
    }
  }
  return hull;
}

double area_of(std::span<const dvec3> corners) {
  double twice = 0;
  for (std::size_t i = 1; i + 1 < corners.size(); ++i)
    twice += turned_left(corners[0], corners[i], corners[i + 1]);
  return twice / 2;
}

/// A face in its own frame, z = 0.
struct FlatFace {
  Frame frame;
  Mesh mesh;                      // triangles counter-clockwise
  std::vector<Triangle> outline;  // sides as triangles without area
  double ground;                  // y on the scene's lowest plane, if y is up there; else nan
};

FlatFace in_own_frame(const Mesh& mesh, const CoplanarFace& face, double ground) {
  FlatFace flat;
  dvec3 n = face.normal;
  if (std::abs(n.z) < 1e-12) n = glm::normalize(dvec3(n.x, n.y, 0));
  const dvec3 y =
      n.z == 0
          ? dvec3{0, 0, 1}
          : glm::normalize(glm::cross(n, std::abs(n.z) < 0.9 ? dvec3{-n.y, n.x, 0} : dvec3{n.z, 0, -n.x}));
  const dvec3 x = glm::cross(y, n);
  MainDirection turn;
  for (const auto& [from, to] : face.outline) {
    const dvec3 along = mesh.vertices[to] - mesh.vertices[from];
    turn.add(glm::dot(along, x), glm::dot(along, y), glm::length(along));
  }
  const double angle = turn.angle(), c = std::cos(angle), s = std::sin(angle);
  flat.frame = {n * face.offset, {c * x + s * y, c * y - s * x, n}};
  flat.ground = flat.frame.axes[1] == dvec3{0, 0, 1} ? ground - flat.frame.origin.z : std::nan("");

  std::map<std::uint32_t, std::uint32_t> number;
  const auto vertex = [&](std::uint32_t old) {
    const auto [at, fresh] = number.emplace(old, static_cast<std::uint32_t>(flat.mesh.vertices.size()));
    if (fresh) {
      dvec3 p = flat.frame.local(mesh.vertices[old]);
      p.z = 0;
      flat.mesh.vertices.push_back(p);
    }
    return at->second;
  };
  for (const std::uint32_t t : face.triangles) {
    Triangle corners{};
    for (unsigned i = 0; i < 3; ++i) corners[i] = vertex(mesh.triangles[t][i]);
    const auto& p = flat.mesh.vertices;
    if (turned_left(p[corners[0]], p[corners[1]], p[corners[2]]) < 0) std::swap(corners[1], corners[2]);
    flat.mesh.triangles.push_back(corners);
  }
  for (const auto& [from, to] : face.outline) flat.outline.push_back({vertex(from), vertex(to), vertex(to)});
  return flat;
}

bool covered(const Mesh& mesh, const dvec3& point) {
  return std::any_of(mesh.triangles.begin(), mesh.triangles.end(), [&](const Triangle& t) {
    const dvec3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    return turned_left(a, b, point) >= 0 && turned_left(b, c, point) >= 0 && turned_left(c, a, point) >= 0 &&
           turned_left(a, b, c) > 0;
  });
}

/// The face's hull, if the face fills it.
std::optional<Piece> whole_face(const FlatFace& face, double tolerance, double inset) {
  std::vector<dvec3> points;
  for (const Triangle& side : face.outline) points.push_back(face.mesh.vertices[side[0]]);
  std::vector<dvec3> hull = without_flat_corners(convex_hull(std::move(points), turned_left), tolerance);
  if (hull.size() < 3 || hull.size() > most_faces) return std::nullopt;
  dvec3 centre = middle_of(hull);
  if (bounds_of(hull).low.y == face.ground) centre.y = face.ground;
  std::vector<HalfSpace> sides;
  double nearest = std::numeric_limits<double>::infinity();  // of the sides that do not stand on the ground
  for (std::size_t i = 0; i < hull.size(); ++i) {
    const dvec3 along = glm::normalize(hull[(i + 1) % hull.size()] - hull[i]);
    const dvec3 outward(along.y, -along.x, 0);
    sides.push_back({outward, std::max(0.0, glm::dot(outward, hull[i] - centre))});
    if (sides.back().offset > 0) nearest = std::min(nearest, sides.back().offset);
  }
  double factor = fitting_factor(sides, centre, face.mesh.vertices, face.outline);
  if (factor == 0 || !covered(face.mesh, middle_of(hull))) return std::nullopt;
  Piece piece;
  if (inset > 0) {
    piece.inset = std::min(inset, nearest / 50);
    factor *= 1 - piece.inset / nearest;
  }
  piece.area = area_of(hull) * factor * factor;
  if (factor < 1) scale_about(hull, centre, factor);
  piece.corners = std::move(hull);
  return piece;
}

/// The face swept along its normal is a solid, so its rectangles are boxes inside of that.
std::vector<Piece> rectangles(const OccluderMaker& maker, const FlatFace& face, double inset) {
  const double height = 1e-3 * maker.size;
  Mesh swept;
  const auto count = static_cast<std::uint32_t>(face.mesh.vertices.size());
  for (const double z : {-height, height}) {
    for (const dvec3& vertex : face.mesh.vertices) swept.vertices.emplace_back(vertex.x, vertex.y, z);
  }
  for (const Triangle& t : face.mesh.triangles) {
    swept.triangles.push_back({t[0] + count, t[1] + count, t[2] + count});
    swept.triangles.push_back({t[0], t[2], t[1]});
  }
  for (const Triangle& side : face.outline) {
    swept.triangles.push_back({side[0], side[1], side[1] + count});
    swept.triangles.push_back({side[0], side[1] + count, side[0] + count});
  }
  std::vector<Piece> pieces;
  for (const Bounds& box :
       inner_boxes(swept, maker.options.polygons_per_object, maker.options.smallest, maker.tolerance())) {
    Piece piece;
    piece.inset = std::min({inset, (box.high.x - box.low.x) / 50, (box.high.y - box.low.y) / 50});
    const double left = box.low.x + piece.inset, right = box.high.x - piece.inset;
    const double bottom = box.low.y == face.ground ? box.low.y : box.low.y + piece.inset;
    const double top = box.high.y - piece.inset;
    piece.corners = {{left, bottom, 0}, {right, bottom, 0}, {right, top, 0}, {left, top, 0}};
    piece.area = area_of(piece.corners);
    pieces.push_back(std::move(piece));
  }
  return pieces;
}

}  // namespace

void add_polygons(OccluderMaker& maker, const Mesh& mesh, std::span<const CoplanarFace> faces,
                  double least_area) {
  struct Found {
    Piece piece;
    Frame frame;
    double deviation;
    bool one_sided;
  };
  std::vector<Found> found;
  const double smallest = maker.options.smallest;
  for (const CoplanarFace& face : faces) {
    if (face.area <= least_area || face.area < smallest * smallest / 2) continue;
    const FlatFace flat = in_own_frame(mesh, face, maker.ground);
    // Coordinates stay exact where all is square to the axes, otherwise our own arithmetic rounds them.
    const bool exact = face.deviation == 0 && largest_coordinate(face.normal) == 1 &&
                       largest_coordinate(flat.frame.axes[0]) == 1;
    const double rounding = 1e-14 * (maker.size + maker.magnitude);
    const double deviation = exact ? 0 : std::max(face.deviation, rounding);
    const double inset = 1000 * deviation;
    std::vector<Piece> pieces;
    if (std::optional<Piece> whole = whole_face(flat, maker.tolerance(), inset)) {
      pieces.push_back(std::move(*whole));
    } else {
      pieces = rectangles(maker, flat, inset);
    }
    for (Piece& piece : pieces) {
      double longest = 0;
      for (const dvec3& a : piece.corners) {
        for (const dvec3& b : piece.corners) longest = std::max(longest, glm::distance(a, b));
      }
      if (piece.area <= least_area || 2 * piece.area < smallest * longest) continue;
      found.push_back({std::move(piece), flat.frame, deviation, deviation > rounding});
    }
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const Found& a, const Found& b) { return a.piece.area > b.piece.area; });
  if (found.size() > maker.options.polygons_per_object) found.resize(maker.options.polygons_per_object);
  for (const Found& f : found) {
    const dvec3 normal = f.frame.axes[2];
    for (const double side : {1.0, -1.0}) {  // seen from the normal's side; from the other
      if (!f.one_sided && side < 0) continue;
      Occluder polygon;
      std::vector<dvec3> corners;
      const dvec3 behind = f.one_sided ? -side * f.deviation * normal : dvec3{};
      for (const dvec3& corner : f.piece.corners) corners.push_back(f.frame.world(corner) + behind);
      if (side < 0) std::reverse(corners.begin(), corners.end());
      polygon.shape = convex_polygon(corners, side * normal);
      polygon.flat = true;
      polygon.one_sided = f.one_sided;
      if (f.deviation > 0) polygon.grazing = 2.02 * f.deviation / f.piece.inset;
      maker.keep(std::move(polygon));
    }
  }
}

}  // namespace vismat
