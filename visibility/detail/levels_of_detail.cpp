// ALGORITHM. Halfedge collapse, cheapest first, by OpenMesh's decimater: v0 goes into v1, vertices stay a subset. The paper
// takes the length of the collapsed edge as what the collapse adds to the error, as Rossignac and Borrel did; so a flat wall
// would be as bad as a sphere. We take the lesser of two numbers d, each with a map from the triangles round v0 (the star)
// onto those that replace them (the fan), which moves no point farther than d and leaves the star's rim where it is:
//  - |v0 - v1|: triangle by triangle, linear, v0 to v1. A triangle at the edge itself goes onto a side of the fan; on a
//    rim, the rim goes onto the new rim.
//  - For inner v0: the greatest distance of star and fan along a direction n, if both are height fields over one polygon of the
//    plane square to n. They are if each triangle of both faces n, and the rim winds round v0 once: then the rim is
//    the border of what the star covers, and a fan with this border whose triangles all face n covers each point once
//    as well. The map is along n. Height differences are linear on each piece of the two triangulations laid over each
//    other, so the greatest is at a vertex of that: on the rim, where it is 0, at v0, or where an edge of the star
//    crosses one of the fan.
// Each triangle keeps the error of what was mapped onto it. A collapse gives the fan the worst of the star's errors plus d: a
// point that was moved by e before and d now is moved by e + d at most. A level's error is the worst of its triangles'.
// Maps of closed surfaces stay onto, so the bound holds for distances both ways.
// A triangle without area, or with all three corners nearly in a line, faces nothing: it makes the second number fail, not be
// wrong; if the first would make one, the collapse is refused. Crossings of nearly parallel edges are left out; there the
// difference is that of their ends, within the slack that is added for rounding.
#include "visibility/detail/levels_of_detail.h"

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <OpenMesh/Tools/Decimater/DecimaterT.hh>
#include <OpenMesh/Tools/Decimater/ModBaseT.hh>
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <limits>
#include <numbers>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <string>

#include "visibility/detail/back_faces.h"
#include "visibility/geometry/plane_geometry.h"

namespace vismat {
namespace {

using glm::dvec2;
using glm::dvec3;
using Triangle = std::array<std::uint32_t, 3>;
struct Traits : OpenMesh::DefaultTraits {
  using Point = OpenMesh::Vec3d;
};
using Surface = OpenMesh::TriMesh_ArrayKernelT<Traits>;

constexpr double least_facing = 0.05;  // cosine: heights along n change by at most 20 m a metre
constexpr double rounding =
    4e-6;  // of the star's size, see ALGORITHM; far above what doubles lose at that slope
constexpr double parallel = 1e-9;  // sine

/// What the second number of ALGORITHM says: `rim` are the star's corners as seen from v0, counter-clockwise, v1 first.
std::optional<double> distance_of_fan(std::span<const dvec3> rim) {
  const std::size_t k = rim.size();
  dvec3 n(0);
  double size = 0;
  for (std::size_t i = 0; i < k; ++i) {
    n += glm::cross(rim[i], rim[(i + 1) % k]);
    size = std::max(size, glm::length(rim[i]));
  }
  if (!(glm::length(n) > 0)) return std::nullopt;
  n = glm::normalize(n);
  const auto faces = [&](const dvec3& a, const dvec3& b) {
    const dvec3 normal = glm::cross(a, b);
    // The second condition is for needles, whose normal is all rounding.
    return glm::dot(normal, n) > least_facing * glm::length(normal) &&
           glm::length(normal) > 1e-8 * glm::length(a) * glm::length(b);
  };
  for (std::size_t i = 0; i < k; ++i) {
    if (!faces(rim[i], rim[(i + 1) % k])) return std::nullopt;
  }
  for (std::size_t i = 1; i + 1 < k; ++i) {
    if (!faces(rim[i] - rim[0], rim[i + 1] - rim[0])) return std::nullopt;
  }
  const dvec3 u = glm::normalize(glm::cross(std::abs(n.x) < 0.6 ? dvec3(1, 0, 0) : dvec3(0, 1, 0), n)),
              v = glm::cross(n, u);
  thread_local std::vector<dvec2> at;
  thread_local std::vector<double> height;
  at.clear();
  height.clear();
  for (const dvec3& p : rim) {
    at.emplace_back(glm::dot(p, u), glm::dot(p, v));
    height.push_back(glm::dot(p, n));
  }
  int turns = 0;
  for (std::size_t i = 0; i < k; ++i) turns += at[i].y <= 0 && at[(i + 1) % k].y > 0 ? 1 : 0;
  if (turns != 1) return std::nullopt;

  double worst = -1;
  for (std::size_t i = 1; i + 1 < k; ++i) {  // v0 under the fan
    const double area = cross(at[i] - at[0], at[i + 1] - at[0]);
    const double a = cross(at[i], at[i + 1]) / area, b = cross(at[i + 1], at[0]) / area, c = 1 - a - b;
    if (std::min({a, b, c}) < -1e-9) continue;
    worst = std::max(worst, std::abs(a * height[0] + b * height[i] + c * height[i + 1]));
  }
  if (worst < 0) return std::nullopt;
  for (std::size_t j = 2; j + 1 < k; ++j) {  // edges of the fan, from v1
    const dvec2 along = at[j] - at[0];
    for (std::size_t i = 1; i < k; ++i) {  // edges of the star, from v0
      const double sine = cross(at[i], along);
      if (i == j || std::abs(sine) <= parallel * glm::length(at[i]) * glm::length(along)) continue;
      const double s = cross(at[0], along) / sine, t = cross(at[0], at[i]) / sine;
      if (s < 0 || s > 1 || t < 0 || t > 1) continue;
      worst = std::max(worst, std::abs(s * height[i] - height[0] - t * (height[j] - height[0])));
    }
  }
  return worst + rounding * size;
}

class AccumulatedError : public OpenMesh::Decimater::ModBaseT<Surface> {
 public:
  using Base = OpenMesh::Decimater::ModBaseT<Surface>;
  using Handle = OpenMesh::Decimater::ModHandleT<AccumulatedError>;

  explicit AccumulatedError(Surface& surface) : Base(surface, false) { surface.add_property(error_); }

  float collapse_priority(const CollapseInfo& collapse) override {
    const double error = after(collapse);
    return error < 0 ? float(Base::ILLEGAL_COLLAPSE) : static_cast<float>(error);
  }
  void preprocess_collapse(const CollapseInfo& collapse) override {
    const double error = after(collapse);
    for (auto face = mesh().vf_iter(collapse.v0); face.is_valid(); ++face)
      mesh().property(error_, *face) = error;
  }
  double worst() {
    double worst = 0;
    for (const auto face : mesh().faces()) worst = std::max(worst, mesh().property(error_, face));
    return worst;
  }

 private:
  /// The error of the triangles that would be left round v0; below 0 if there must be none such.
  double after(const CollapseInfo& collapse) {
    double before = 0;
    for (auto face = mesh().vf_iter(collapse.v0); face.is_valid(); ++face) {
      before = std::max(before, mesh().property(error_, *face));
    }
    rim_.clear();
    auto spoke = collapse.v0v1;
    do {
      const auto d = mesh().point(mesh().to_vertex_handle(spoke)) - collapse.p0;
      rim_.emplace_back(d[0], d[1], d[2]);
      spoke = mesh().ccw_rotated_halfedge_handle(spoke);
    } while (spoke.is_valid() && spoke != collapse.v0v1);
    const double length = glm::length(rim_[0]);
    if (spoke.is_valid() && !mesh().is_boundary(collapse.v0)) {
      if (const auto distance = distance_of_fan(rim_)) return before + std::min(length, *distance);
    }
    for (auto face = mesh().vf_iter(collapse.v0); face.is_valid(); ++face) {
      if (*face == collapse.fl || *face == collapse.fr) continue;
      std::array<dvec3, 3> corner;
      unsigned i = 0;
      for (auto vertex = mesh().fv_iter(*face); vertex.is_valid(); ++vertex) {
        const auto p = mesh().point(*vertex == collapse.v0 ? collapse.v1 : *vertex) - collapse.p0;
        corner[i++] = {p[0], p[1], p[2]};
      }
      const dvec3 ab = corner[1] - corner[0], ac = corner[2] - corner[0];
      if (!(glm::length(glm::cross(ab, ac)) > 1e-8 * glm::length(ab) * glm::length(ac))) return -1;
    }
    return before + length;
  }

  OpenMesh::FPropHandleT<double> error_;
  std::vector<dvec3> rim_;
};

/// Triangles by corners such that each side is in at most two of them, once each way, and those at a corner hang together;
/// vertex_of_corner leads back. Empty if there is no way without moving triangles apart that share two such corners.
std::vector<Triangle> manifold(const Mesh& mesh, std::vector<std::uint32_t>& vertex_of_corner) {
  std::vector<std::uint32_t> same(3 * mesh.triangles.size());
  std::iota(same.begin(), same.end(), 0);
  const auto find = [&](std::uint32_t c) {
    while (same[c] != c) c = same[c] = same[same[c]];
    return c;
  };
  const auto corner_at = [&](const MeshSide& side, unsigned end) {
    const Triangle& t = mesh.triangles[side.triangle];
    for (std::uint32_t i = 0; i < 3; ++i) {
      if (t[i] == side.ends[end]) return 3 * side.triangle + i;
    }
    return 3 * side.triangle;
  };
  const std::vector<MeshSide> sides = sides_of(mesh);
  for (std::size_t i = 0; i < sides.size();) {
    std::size_t to = i;
    while (to < sides.size() && sides[to].ends == sides[i].ends) ++to;
    if (to - i == 2 && sides[i].forward != sides[i + 1].forward) {
      for (const unsigned end : {0u, 1u}) {
        const std::uint32_t a = find(corner_at(sides[i], end)), b = find(corner_at(sides[i + 1], end));
        same[std::max(a, b)] = std::min(a, b);
      }
    }
    i = to;
  }
  std::vector<std::uint32_t> number(same.size());
  std::vector<Triangle> triangles(mesh.triangles.size());
  for (std::uint32_t c = 0; c < same.size(); ++c) {
    if (find(c) == c) {
      number[c] = static_cast<std::uint32_t>(vertex_of_corner.size());
      vertex_of_corner.push_back(mesh.triangles[c / 3][c % 3]);
    }
    triangles[c / 3][c % 3] = number[find(c)];
  }
  std::vector<std::array<std::uint32_t, 2>> runs;
  for (const Triangle& t : triangles) {
    for (unsigned i = 0; i < 3; ++i) runs.push_back({t[i], t[(i + 1) % 3]});
  }
  std::sort(runs.begin(), runs.end());
  if (std::adjacent_find(runs.begin(), runs.end()) != runs.end()) triangles.clear();
  return triangles;
}

}  // namespace

std::vector<LevelOfDetail> levels_of_detail(const Mesh& mesh) {
  std::vector<LevelOfDetail> levels = {{0, mesh.triangles}};
  std::vector<std::uint32_t> vertex_of_corner;
  const std::vector<Triangle> triangles = manifold(mesh, vertex_of_corner);
  if (triangles.empty()) return levels;

  Surface surface;
  OpenMesh::VPropHandleT<std::uint32_t> source;
  surface.add_property(source);
  for (const std::uint32_t vertex : vertex_of_corner) {
    const dvec3& p = mesh.vertices[vertex];
    surface.property(source, surface.add_vertex({p.x, p.y, p.z})) = vertex;
  }
  for (const auto& [a, b, c] : triangles) {
    const auto handle = [](std::uint32_t i) { return Surface::VertexHandle(static_cast<int>(i)); };
    if (!surface.add_face(handle(a), handle(b), handle(c)).is_valid()) return levels;
  }
  OpenMesh::Decimater::DecimaterT<Surface> decimater(surface);
  AccumulatedError::Handle error;
  decimater.add(error);
  decimater.initialize();
  while (true) {
    const std::size_t before = surface.n_faces();
    decimater.decimate_to_faces(0, before / 2);
    surface.garbage_collection();  // or the next round would count what is gone
    if (surface.n_faces() * 4 > before * 3) return levels;
    LevelOfDetail level;
    level.error = decimater.module(error).worst();
    level.triangles.reserve(surface.n_faces());
    for (const auto face : surface.faces()) {
      Triangle& t = level.triangles.emplace_back();
      unsigned i = 0;
      for (auto vertex = surface.cfv_iter(face); vertex.is_valid(); ++vertex)
        t[i++] = surface.property(source, *vertex);
    }
    levels.push_back(std::move(level));
  }
}

double pixels_per_radian(const Screen& screen) {
  if (screen.width == 0 || screen.height == 0 || !(screen.field_of_view > 0 && screen.field_of_view < 180)) {
    throw std::invalid_argument(
        "screen: need a width and a height above 0 and a field of view between 0 and 180 degrees");
  }
  const double half = screen.width / 2.0;
  const double focal = half / std::tan(double{screen.field_of_view} * std::numbers::pi / 360);
  // Pixels a radian, away from the middle, are focal / cos^2.
  return focal + (half * half + screen.height / 2.0 * (screen.height / 2.0)) / focal;
}

double deviation_in_pixels(double error, const Box& cell, const Box& object, double per_radian) {
  if (error == 0) return 0;
  double square = 0;
  for (unsigned axis = 0; axis < 3; ++axis) {
    const double gap = std::max(
        {0.0, double{cell.low[axis]} - object.high[axis], double{object.low[axis]} - cell.high[axis]});
    square += gap * gap;
  }
  const double distance = std::sqrt(square);
  // Two points at least so far away, `error` apart: the angle between them is greatest where both are nearest.
  if (!(error < 2 * distance)) return std::numeric_limits<double>::infinity();
  return 2 * std::asin(error / (2 * distance)) * per_radian * (1 + 1e-9);
}

struct LevelsOfDetail::Object {
  Mesh mesh;
  Box bounds;
  std::vector<LevelOfDetail> levels;
  std::vector<BackFaces> back_faces;  // one for each level, if the object is closed
};

LevelsOfDetail::LevelsOfDetail(const Scene& scene, const Screen& screen, unsigned threads,
                               const Progress& progress)
    : per_radian_(pixels_per_radian(screen)), objects_(scene.object_count) {
  std::vector<std::vector<std::uint32_t>> triangles(scene.object_count);
  for (std::uint32_t t = 0; t < scene.object_of_triangle.size(); ++t)
    triangles[scene.object_of_triangle[t]].push_back(t);
  const std::vector<Box> bounds = object_bounds(scene);
  parallel_for(
      scene.object_count, threads,
      [&](std::uint64_t i) {
        Object& object = objects_[i];
        object.mesh = mesh_of(scene.vertices, scene.indices, triangles[i]);
        object.bounds = bounds[i];
        object.levels = levels_of_detail(object.mesh);
        if (object.mesh.triangles.empty() || !is_closed_outward(object.mesh)) return;
        for (const LevelOfDetail& level : object.levels)
          object.back_faces.emplace_back(object.mesh.vertices, level.triangles);
      },
      progress);
}

LevelsOfDetail::~LevelsOfDetail() = default;
LevelsOfDetail::LevelsOfDetail(LevelsOfDetail&&) noexcept = default;
LevelsOfDetail& LevelsOfDetail::operator=(LevelsOfDetail&&) noexcept = default;

std::uint32_t LevelsOfDetail::object_count() const {
  return static_cast<std::uint32_t>(objects_.size());
}
const Mesh& LevelsOfDetail::mesh(std::uint32_t object) const {
  return objects_.at(object).mesh;
}
std::span<const LevelOfDetail> LevelsOfDetail::levels(std::uint32_t object) const {
  return objects_.at(object).levels;
}

std::uint32_t LevelsOfDetail::level_for(const Box& cell, std::uint32_t object) const {
  const Object& o = objects_.at(object);
  auto level = static_cast<std::uint32_t>(o.levels.size() - 1);
  while (level > 0 && deviation_in_pixels(o.levels[level].error, cell, o.bounds, per_radian_) >= 1) --level;
  return level;
}

std::vector<std::uint32_t> LevelsOfDetail::levels_for(const Box& cell) const {
  std::vector<std::uint32_t> levels(objects_.size());
  for (std::uint32_t object = 0; object < levels.size(); ++object) levels[object] = level_for(cell, object);
  return levels;
}

std::uint64_t LevelsOfDetail::facing_triangles(const Box& cell, std::uint32_t object,
                                               std::uint32_t level) const {
  const Object& o = objects_.at(object);
  bool apart = false;
  for (unsigned axis = 0; axis < 3; ++axis) {
    apart = apart || cell.low[axis] > o.bounds.high[axis] || cell.high[axis] < o.bounds.low[axis];
  }
  return apart && !o.back_faces.empty() ? o.back_faces.at(level).facing(cell)
                                        : o.levels.at(level).triangles.size();
}

std::uint64_t LevelsOfDetail::visible_triangles(const Box& cell,
                                                std::span<const std::uint32_t> objects) const {
  std::uint64_t triangles = 0;
  for (const std::uint32_t object : objects) {
    triangles += facing_triangles(cell, object, level_for(cell, object));
  }
  return triangles;
}

}  // namespace vismat
