// ALGORITHM.
//  - Convex parts: coplanar triangles are merged into faces, corners are the vertices where three faces meet; the polytope
//    over them, shrunk about its middle until no triangle enters it (by rounding's 1e-7), or refused if that takes more
//    than 1 %. So there is no separate test of convexity.
//  - Other closed parts: inner boxes in the frame in which most wall area is square to the axes, all parts of the object
//    together, so that cavities stay empty.
// The ground rule needs bottom corners on the lowest plane exactly and sides that are vertical exactly; so solids are shrunk
// about a point of that plane, and boxes never along z.
#include "visibility/shadows/solid_occluders.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <utility>

#include "visibility/geometry/point_bounds.h"
#include "visibility/shadows/inner_boxes.h"

namespace vismat {
namespace {

using glm::dvec3;
using Triangle = std::array<std::uint32_t, 3>;

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

std::shared_ptr<const Enclosure> enclosure_of(Mesh surface) {
  const Bounds bounds = bounds_of(surface.vertices);
  return std::make_shared<const Enclosure>(Enclosure{std::move(surface), bounds});
}

Convex box_in(const Frame& frame, const Bounds& box) {
  std::vector<dvec3> corners;
  for (unsigned corner = 0; corner < 8; ++corner) {
    corners.push_back(frame.world({(corner & 1 ? box.high : box.low).x, (corner & 2 ? box.high : box.low).y,
                                   (corner & 4 ? box.high : box.low).z}));
  }
  return convex_turned_box(std::move(corners));
}

}  // namespace

int add_convex(OccluderMaker& maker, const Mesh& part, std::span<const CoplanarFace> faces) {
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
  const double factor = fitting_factor(sides, centre, part.vertices, part.triangles);
  if (factor == 0) return 0;
  Occluder solid;
  solid.shape = std::move(*shape);
  if (factor < 1) {
    scale_about(solid.shape.vertices, centre, factor);
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
  if (second >= maker.options.smallest) maker.keep(std::move(solid));
  return winding;
}

double add_boxes(OccluderMaker& maker, const Mesh& closed) {
  MainDirection turn;
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
  for (Bounds box :
       inner_boxes(turned, maker.options.boxes_per_object, maker.options.smallest, maker.tolerance())) {
    box.low += margin, box.high -= margin;
    const dvec3 side = box.high - box.low;
    if (std::min({side.x, side.y, side.z}) <= 0) continue;
    largest_side = std::max({largest_side, side.x * side.y, side.y * side.z, side.z * side.x});
    if (!within) within = enclosure_of(closed);
    Occluder solid;
    solid.shape = box_in(frame, box);
    solid.within = within;
    maker.keep(std::move(solid));
  }
  return largest_side;
}

}  // namespace vismat
