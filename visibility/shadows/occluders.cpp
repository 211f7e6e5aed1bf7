// ALGORITHM. Candidates by search, soundness by proof at the end, see find_occluders.
//  - Convex parts: coplanar triangles are merged into faces, corners are the vertices where three faces meet; the polytope
//    over them, shrunk about its middle until no triangle enters it (by rounding's 1e-7), or refused if that takes more
//    than 1 %. So there is no separate test of convexity.
//  - Other closed parts: inner boxes in the frame in which most wall area is square to the axes, all parts of the object
//    together, so that cavities stay empty.
//  - Flat faces: the convex hull of the outline if the face fills it, else inner rectangles: the boxes again, inside the
//    face swept a little along its normal.
// The ground rule needs bottom corners on the lowest plane exactly and sides that are vertical exactly; so solids are shrunk
// about a point of that plane, and boxes never along z.
// Single triangles as occluders were tried in VISIBILITY's prototype: they hide a quarter of what whole walls do.
#include "visibility/shadows/occluders.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <utility>

#include "matrix/base/parallel.h"
#include "visibility/shadows/coplanar.h"
#include "visibility/shadows/inner_boxes.h"

namespace vismat {
namespace {

using glm::dvec3;
using Triangle = std::array<std::uint32_t, 3>;

constexpr std::size_t most_faces = 128;  // of a solid: rounder ones cost more as occluders than boxes in them
constexpr double least_fit = 0.99;

struct Bounds {
  dvec3 low{std::numeric_limits<double>::infinity()}, high{-std::numeric_limits<double>::infinity()};
};

Bounds bounds_of(std::span<const dvec3> points) {
  Bounds bounds;
  for (const dvec3& p : points) bounds.low = glm::min(bounds.low, p), bounds.high = glm::max(bounds.high, p);
  return bounds;
}

double largest(const dvec3& v) {
  return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

/// Where one object's occluders are made.
struct Maker {
  const OccluderOptions& options;
  double ground, depth;  // the lowest plane, and how far below it solids reach
  std::uint32_t object = 0;
  std::vector<Occluder> made{};
  // Of the object's coordinates:
  double size = 0;                                                // the bounding box's longest side
  double magnitude = 0;                                           // the largest
  double tolerance() const { return 1e-6 * (size + magnitude); }  // how rough a flat face may be
  double rounding() const {
    return 1e-10 * size + 1e-13 * magnitude;
  }  // what our own arithmetic may be off by, and more
};

/// Orthonormal axes as columns.
struct Frame {
  dvec3 origin{};
  glm::dmat3 axes{1.0};
  dvec3 local(const dvec3& world) const { return (world - origin) * axes; }
  dvec3 world(const dvec3& p) const { return origin + axes * p; }
};

/// The direction, modulo a right angle, that most of the weight has; exactly 0 if it is nearly.
class Turn {
 public:
  void add(double x, double y, double weight) {
    double angle = std::fmod(std::atan2(y, x), quarter);
    if (angle < 0) angle += quarter;
    const auto bin = std::min<std::size_t>(static_cast<std::size_t>(angle / quarter * bins), bins - 1);
    weights_[bin] += weight;
    // Averaged as a unit vector of four times the angle, so that 0 and a right angle are near.
    x_[bin] += weight * std::cos(4 * angle), y_[bin] += weight * std::sin(4 * angle);
  }
  double angle() const {
    std::size_t best = 0;
    double most = -1;
    for (std::size_t i = 0; i < bins; ++i) {
      const double weight = weights_[i] + weights_[(i + 1) % bins];
      if (weight > most) most = weight, best = i;
    }
    const std::size_t next = (best + 1) % bins;
    const double angle = std::atan2(y_[best] + y_[next], x_[best] + x_[next]) / 4;
    return std::abs(angle) < 1e-6 ? 0 : angle;
  }

 private:
  static constexpr std::size_t bins = 90;
  static constexpr double quarter = std::numbers::pi / 2;
  std::array<double, bins> weights_{}, x_{}, y_{};
};

/// Solids and polygons whose lowest corners lie on the ground, with vertical edges up from them.
bool stands_upright(const Convex& shape, double ground) {
  bool stands = false;
  for (const Convex::Edge& edge : shape.edges) {
    const dvec3 &a = shape.vertices[edge.ends[0]], &b = shape.vertices[edge.ends[1]];
    stands |= a.z == ground;
    if ((a.z == ground) != (b.z == ground) && (a.x != b.x || a.y != b.y)) return false;
  }
  return stands;
}

void keep(Maker& maker, Occluder occluder) {
  Convex& shape = occluder.shape;
  if (maker.options.extend_below_ground && stands_upright(shape, maker.ground) &&
      (!occluder.flat || std::abs(shape.faces[0].normal.z) < 1e-15)) {
    for (dvec3& vertex : shape.vertices) {
      if (vertex.z == maker.ground) vertex.z -= maker.depth;
    }
    for (Convex::Face& face : shape.faces) face.offset = farthest_beyond(shape.vertices, face.normal, 0);
  }
  occluder.object = maker.object;
  maker.made.push_back(std::move(occluder));
}

struct HalfSpace {
  dvec3 normal;
  double offset;  // dot(normal, x - centre) <= offset
};

/// The greatest factor up to 1 by which a convex shape that holds `centre` can be scaled about it so that no simplex has a
/// point in its interior, as far as its own sides tell that; 0 if none.
double fit(std::span<const HalfSpace> sides, const dvec3& centre, std::span<const dvec3> vertices,
           std::span<const Triangle> simplices) {
  double least = 1;
  for (const Triangle& corners : simplices) {
    double most = 0;
    for (const HalfSpace& side : sides) {
      double nearest = std::numeric_limits<double>::infinity();
      for (const std::uint32_t corner : corners) {
        nearest = std::min(nearest, glm::dot(side.normal, vertices[corner] - centre));
      }
      if (nearest < 0) continue;
      most = std::max(most, side.offset > 0 ? nearest / side.offset : 1.0);
      if (most >= least) break;
    }
    least = std::min(least, most);
    if (least < least_fit) return 0;
  }
  return least < 1 - 1e-13 ? least * (1 - 1e-10) : 1;
}

/// The polytope over the corners where at least three faces meet; nothing if they do not make one.
std::optional<Convex> polytope(const Mesh& part, std::span<const CoplanarFace> faces) {
  if (faces.size() < 4 || faces.size() > most_faces) return std::nullopt;
  std::vector<unsigned> faces_at(part.vertices.size());
  std::vector<std::map<std::uint32_t, std::uint32_t>> next(faces.size());
  for (std::size_t f = 0; f < faces.size(); ++f) {
    for (const auto& [from, to] : faces[f].outline) {
      if (!next[f].emplace(from, to).second) return std::nullopt;
      ++faces_at[from];
    }
  }
  std::vector<std::uint32_t> corner_of(part.vertices.size(), 0xffffffff);
  std::vector<dvec3> vertices;
  std::vector<std::vector<std::uint16_t>> loops;
  for (const auto& outline : next) {
    std::vector<std::uint16_t> loop;
    if (outline.empty()) return std::nullopt;
    std::size_t steps = 0;
    std::uint32_t at = outline.begin()->first;
    do {
      if (faces_at[at] >= 3) {
        if (corner_of[at] == 0xffffffff) {
          corner_of[at] = static_cast<std::uint32_t>(vertices.size());
          vertices.push_back(part.vertices[at]);
          if (vertices.size() > 2 * most_faces) return std::nullopt;
        }
        loop.push_back(static_cast<std::uint16_t>(corner_of[at]));
      }
      const auto step = outline.find(at);
      if (step == outline.end()) return std::nullopt;
      at = step->second;
      ++steps;
    } while (at != outline.begin()->first && steps <= outline.size());
    if (steps != outline.size() || loop.size() < 3) return std::nullopt;
    loops.push_back(std::move(loop));
  }
  try {
    return convex_from_faces(std::move(vertices), std::move(loops));
  } catch (const std::invalid_argument&) {
    return std::nullopt;  // faces that do not meet along whole edges
  }
}

dvec3 middle_of(std::span<const dvec3> points) {
  dvec3 sum{};
  for (const dvec3& p : points) sum += p - points[0];
  return points[0] + sum / static_cast<double>(points.size());
}

void scale(std::vector<dvec3>& points, const dvec3& centre, double factor) {
  for (dvec3& p : points) p = centre + factor * (p - centre);
}

std::shared_ptr<const Enclosure> enclosure_of(Mesh surface) {
  const Bounds bounds = bounds_of(surface.vertices);
  return std::make_shared<const Enclosure>(Enclosure{std::move(surface), bounds.low, bounds.high});
}

/// How often the closed part winds round its middle if it is convex, and then it is kept as a solid; else 0.
int add_convex(Maker& maker, const Mesh& part, std::span<const CoplanarFace> faces) {
  std::optional<Convex> shape = polytope(part, faces);
  if (!shape) return 0;
  dvec3 centre = middle_of(shape->vertices);
  if (bounds_of(shape->vertices).low.z == maker.ground) centre.z = maker.ground;
  std::vector<HalfSpace> sides;
  for (const Convex::Face& face : shape->faces) {
    double offset = 0;
    for (const dvec3& vertex : shape->vertices)
      offset = std::max(offset, glm::dot(face.normal, vertex - centre));
    sides.push_back({face.normal, offset});
  }
  const double factor = fit(sides, centre, part.vertices, part.triangles);
  if (factor == 0) return 0;
  Occluder solid;
  solid.shape = std::move(*shape);
  if (factor < 1) {
    scale(solid.shape.vertices, centre, factor);
    for (Convex::Face& face : solid.shape.faces)
      face.offset = farthest_beyond(solid.shape.vertices, face.normal, 0);
    solid.within = enclosure_of(part);
  }
  const int winding = winding_number(part, middle_of(solid.shape.vertices));
  if (winding == 0) return 0;
  const Bounds bounds = bounds_of(solid.shape.vertices);
  const dvec3 extent = bounds.high - bounds.low;
  const double second =
      std::max(std::min(extent.x, extent.y), std::min(std::max(extent.x, extent.y), extent.z));
  if (second >= maker.options.smallest) keep(maker, std::move(solid));
  return winding;
}

Convex box_in(const Frame& frame, const InnerBox& box) {
  std::vector<dvec3> vertices;  // corner bits: 1 = high x, 2 = high y, 4 = high z
  for (unsigned corner = 0; corner < 8; ++corner) {
    vertices.push_back(frame.world({(corner & 1 ? box.high : box.low).x, (corner & 2 ? box.high : box.low).y,
                                    (corner & 4 ? box.high : box.low).z}));
  }
  return convex_from_faces(
      std::move(vertices),
      {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}});
}

/// Boxes inside closed parts, taken together; returns the largest of their sides.
double add_boxes(Maker& maker, const Mesh& closed) {
  Turn turn;
  for (const Triangle& t : closed.triangles) {
    const dvec3 normal = glm::cross(closed.vertices[t[1]] - closed.vertices[t[0]],
                                    closed.vertices[t[2]] - closed.vertices[t[0]]);
    const double across = std::hypot(normal.x, normal.y);
    if (across > std::abs(normal.z)) turn.add(normal.x, normal.y, across);
  }
  const double angle = turn.angle();
  Frame frame;
  Mesh turned = closed;
  if (angle != 0) {
    const Bounds bounds = bounds_of(closed.vertices);
    frame.origin = {(bounds.low.x + bounds.high.x) / 2, (bounds.low.y + bounds.high.y) / 2, 0};
    frame.axes = {{std::cos(angle), std::sin(angle), 0}, {-std::sin(angle), std::cos(angle), 0}, {0, 0, 1}};
    for (dvec3& vertex : turned.vertices) vertex = frame.local(vertex);
  }
  const dvec3 margin = angle == 0 ? dvec3{} : dvec3{maker.rounding(), maker.rounding(), 0};
  double largest_side = 0;
  std::shared_ptr<const Enclosure> within;
  for (InnerBox box :
       inner_boxes(turned, maker.options.boxes_per_object, maker.options.smallest, maker.tolerance())) {
    box.low += margin, box.high -= margin;
    const dvec3 side = box.high - box.low;
    if (std::min({side.x, side.y, side.z}) <= 0) continue;
    largest_side = std::max({largest_side, side.x * side.y, side.y * side.z, side.z * side.x});
    if (!within) within = enclosure_of(closed);
    Occluder solid;
    solid.shape = box_in(frame, box);
    solid.within = within;
    keep(maker, std::move(solid));
  }
  return largest_side;
}

/// A convex polygon in a face, and how far all of the face's outline stays away from it but for what stands on the ground.
struct Piece {
  std::vector<dvec3> corners;  // in the plane, counter-clockwise about its normal
  double area = 0, inset = 0;
};

double cross(const dvec3& o, const dvec3& a, const dvec3& b) {
  return (a.x - o.x) * (b.y - o.y) - (a.y - o.y) * (b.x - o.x);
}

/// The hull of points in the xy plane, counter-clockwise, without corners that stand out by less than `tolerance`.
std::vector<dvec3> hull_of(std::vector<dvec3> points, double tolerance) {
  std::sort(points.begin(), points.end(),
            [](const dvec3& a, const dvec3& b) { return std::pair(a.x, a.y) < std::pair(b.x, b.y); });
  std::vector<dvec3> hull;
  for (const int pass : {0, 1}) {
    const std::size_t base = hull.size();
    for (const dvec3& p : points) {
      while (hull.size() >= base + 2 && cross(hull[hull.size() - 2], hull.back(), p) <= 0) hull.pop_back();
      hull.push_back(p);
    }
    hull.pop_back();
    if (pass == 0) std::reverse(points.begin(), points.end());
  }
  for (std::size_t i = 0; i < hull.size() && hull.size() > 3;) {
    const dvec3 &before = hull[(i + hull.size() - 1) % hull.size()], &after = hull[(i + 1) % hull.size()];
    if (cross(before, hull[i], after) <= tolerance * glm::length(after - before)) {
      hull.erase(hull.begin() + static_cast<std::ptrdiff_t>(i));
    } else {
      ++i;
    }
  }
  return hull;
}

double area_of(std::span<const dvec3> corners) {
  double twice = 0;
  for (std::size_t i = 1; i + 1 < corners.size(); ++i) twice += cross(corners[0], corners[i], corners[i + 1]);
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
  Turn turn;
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
    if (cross(p[corners[0]], p[corners[1]], p[corners[2]]) < 0) std::swap(corners[1], corners[2]);
    flat.mesh.triangles.push_back(corners);
  }
  for (const auto& [from, to] : face.outline) flat.outline.push_back({vertex(from), vertex(to), vertex(to)});
  return flat;
}

bool covered(const Mesh& mesh, const dvec3& point) {
  return std::any_of(mesh.triangles.begin(), mesh.triangles.end(), [&](const Triangle& t) {
    const dvec3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    return cross(a, b, point) >= 0 && cross(b, c, point) >= 0 && cross(c, a, point) >= 0 &&
           cross(a, b, c) > 0;
  });
}

/// The face's hull, if the face fills it.
std::optional<Piece> whole_face(const FlatFace& face, double tolerance, double inset) {
  std::vector<dvec3> points;
  for (const Triangle& side : face.outline) points.push_back(face.mesh.vertices[side[0]]);
  std::vector<dvec3> hull = hull_of(std::move(points), tolerance);
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
  double factor = fit(sides, centre, face.mesh.vertices, face.outline);
  if (factor == 0 || !covered(face.mesh, middle_of(hull))) return std::nullopt;
  Piece piece;
  if (inset > 0) {
    piece.inset = std::min(inset, nearest / 50);
    factor *= 1 - piece.inset / nearest;
  }
  piece.area = area_of(hull) * factor * factor;
  if (factor < 1) scale(hull, centre, factor);
  piece.corners = std::move(hull);
  return piece;
}

/// The face swept along its normal is a solid, so its rectangles are boxes inside of that.
std::vector<Piece> rectangles(const Maker& maker, const FlatFace& face, double inset) {
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
  for (const InnerBox& box :
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

/// The largest polygons of the faces of `mesh`, none smaller than `least_area`.
void add_polygons(Maker& maker, const Mesh& mesh, std::span<const CoplanarFace> faces, double least_area) {
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
    // Coordinates of planes square to an axis are exact; others round.
    // Coordinates stay exact where all is square to the axes, otherwise our own arithmetic rounds them.
    const bool exact = face.deviation == 0 && largest(face.normal) == 1 && largest(flat.frame.axes[0]) == 1;
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
      keep(maker, std::move(polygon));
    }
  }
}

Mesh part_of(const Mesh& mesh, std::span<const std::uint32_t> triangles) {
  Mesh part;
  std::map<std::uint32_t, std::uint32_t> number;
  for (const std::uint32_t t : triangles) {
    Triangle corners{};
    for (unsigned i = 0; i < 3; ++i) {
      const auto [at, fresh] =
          number.emplace(mesh.triangles[t][i], static_cast<std::uint32_t>(part.vertices.size()));
      if (fresh) part.vertices.push_back(mesh.vertices[mesh.triangles[t][i]]);
      corners[i] = at->second;
    }
    part.triangles.push_back(corners);
  }
  return part;
}

void append(Mesh& mesh, const Mesh& other) {
  const auto base = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), other.vertices.begin(), other.vertices.end());
  for (const Triangle& t : other.triangles) mesh.triangles.push_back({t[0] + base, t[1] + base, t[2] + base});
}

/// Whether as many triangles run along each side one way as the other, once the part is closed where it is open on the lowest
/// plane, through which no sight line enters.
bool close_on_ground(Mesh& part, double ground) {
  const std::vector<MeshSide> sides = sides_of(part);
  std::vector<Triangle> cap;  // a cone over the open sides
  for (std::size_t i = 0; i < sides.size();) {
    int balance = 0;
    const std::array<std::uint32_t, 2> ends = sides[i].ends;
    for (; i < sides.size() && sides[i].ends == ends; ++i) balance += sides[i].forward ? 1 : -1;
    if (balance == 0) continue;
    if (part.vertices[ends[0]].z != ground || part.vertices[ends[1]].z != ground) return false;
    const std::uint32_t top = cap.empty() ? ends[0] : cap[0][2];
    const auto [from, to] = balance > 0 ? std::pair(ends[1], ends[0]) : std::pair(ends[0], ends[1]);
    cap.insert(cap.end(), static_cast<std::size_t>(std::abs(balance)), {from, to, top});
  }
  std::erase_if(cap, [](const Triangle& t) { return t[0] == t[2] || t[1] == t[2]; });
  part.triangles.insert(part.triangles.end(), cap.begin(), cap.end());
  return true;
}

void make_occluders(Maker& maker, const Mesh& mesh) {
  if (mesh.triangles.empty()) return;
  const Bounds bounds = bounds_of(mesh.vertices);
  maker.size = largest(bounds.high - bounds.low);
  maker.magnitude = std::max(largest(bounds.high), largest(bounds.low));

  const std::vector<MeshSide> sides = sides_of(mesh);
  const std::vector<std::uint32_t> part_of_triangle = parts_by_sides(mesh, sides);
  std::vector<std::vector<std::uint32_t>> parts(
      *std::max_element(part_of_triangle.begin(), part_of_triangle.end()) + 1u);
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) parts[part_of_triangle[t]].push_back(t);

  Mesh solids, hollows, open;  // all closed parts; those that are not convex; the rest
  bool outward = false, inward = false;
  for (const std::vector<std::uint32_t>& triangles : parts) {
    Mesh part = part_of(mesh, triangles);
    orient(part, sides_of(part));
    if (!close_on_ground(part, maker.options.extend_below_ground ? maker.ground : std::nan(""))) {
      append(open, part);
      continue;
    }
    append(solids, part);
    const int winding = add_convex(maker, part, coplanar_faces(part, sides_of(part), maker.tolerance()));
    if (winding == 0) append(hollows, part);
    outward |= winding > 0, inward |= winding < 0;
  }
  if (!hollows.triangles.empty() || (outward && inward)) {  // a convex part may be another's cavity
    const double largest_side = add_boxes(maker, solids);
    add_polygons(maker, hollows, coplanar_faces(hollows, sides_of(hollows), maker.tolerance()),
                 1.1 * largest_side);
  }
  if (!open.triangles.empty())
    add_polygons(maker, open, coplanar_faces(open, sides_of(open), maker.tolerance()), 0);
}

bool is_finite(const Scene& scene, std::span<const std::uint32_t> triangles) {
  return std::all_of(triangles.begin(), triangles.end(), [&](std::uint32_t t) {
    for (unsigned i = 0; i < 3; ++i) {
      const glm::vec3& p = scene.vertices[scene.indices[3 * std::size_t{t} + i]];
      if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) return false;
    }
    return true;
  });
}

}  // namespace

float lowest_point(const Scene& scene) {
  float lowest = std::numeric_limits<float>::infinity();
  for (const std::uint32_t index : scene.indices) lowest = std::min(lowest, scene.vertices[index].z);
  return scene.indices.empty() ? 0 : lowest;
}

std::vector<Occluder> find_occluders(const Scene& scene, const OccluderOptions& options) {
  std::vector<std::uint32_t> begin(scene.object_count + 1u), of(scene.object_of_triangle.size());
  for (const std::uint32_t object : scene.object_of_triangle) ++begin[object + 1];
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  std::vector<std::uint32_t> at = begin;
  for (std::uint32_t t = 0; t < of.size(); ++t) of[at[scene.object_of_triangle[t]]++] = t;

  std::vector<dvec3> corners(scene.vertices.begin(), scene.vertices.end());
  const Bounds bounds = bounds_of(corners);
  const double depth = corners.empty() ? 0 : glm::length(bounds.high - bounds.low);
  const double ground = lowest_point(scene);

  std::vector<std::vector<Occluder>> made(scene.object_count);
  parallel_for(scene.object_count, options.threads, [&](std::uint64_t object) {
    if (!scene.see_through.empty() && scene.see_through[object]) return;
    const std::span<const std::uint32_t> triangles(of.data() + begin[object],
                                                   begin[object + 1] - begin[object]);
    if (!is_finite(scene, triangles)) return;
    Maker maker{options, ground, depth, static_cast<std::uint32_t>(object)};
    make_occluders(maker, mesh_of(scene.vertices, scene.indices, triangles));
    made[object] = std::move(maker.made);
  });
  std::vector<Occluder> all;
  for (std::vector<Occluder>& some : made) {
    all.insert(all.end(), std::make_move_iterator(some.begin()), std::make_move_iterator(some.end()));
  }
  return all;
}

bool blocks_from(const Occluder& occluder, const Convex& cell) {
  if (occluder.grazing > 0) {
    const Convex::Face& front = occluder.shape.faces[0];
    double height = -farthest_beyond(cell.vertices, -front.normal, -front.offset);
    if (!occluder.one_sided)
      height = std::max(height, -farthest_beyond(cell.vertices, front.normal, front.offset));
    double farthest = 0;
    for (const dvec3& from : cell.vertices) {
      for (const dvec3& to : occluder.shape.vertices) farthest = std::max(farthest, glm::distance(from, to));
    }
    if (height <= occluder.grazing * farthest) return false;
  }
  if (!occluder.within) return true;
  const Enclosure& around = *occluder.within;
  Bounds bounds = bounds_of(cell.vertices);
  const dvec3 margin(1e-6 * largest(around.high - around.low) + 1e-9 * largest(bounds.high));
  bounds.low -= margin, bounds.high += margin;
  for (int i = 0; i < 3; ++i) {
    if (bounds.low[i] > around.high[i] || bounds.high[i] < around.low[i]) return true;
  }
  return !enters_box(around.surface, bounds.low, bounds.high) &&
         winding_number(around.surface, (bounds.low + bounds.high) / 2.0) == 0;
}

}  // namespace vismat
