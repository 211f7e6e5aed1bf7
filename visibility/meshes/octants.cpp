// ALGORITHM. Level by level: each octant's triangles are cut at its three middle planes. An edge is cut from its lesser end,
// whichever triangle it belongs to, and a triangle is cut into triangles, so that neighbours on both sides of an edge get equal
// vertices, which weld() joins. Assigning whole triangles by their middles, as tiles are, was not taken: a floor of 30 m would
// be in one octant and leave those beside it empty.
#include "visibility/meshes/octants.h"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <tuple>
#include <utility>

#include <glm/geometric.hpp>

#include "visibility/meshes/components.h"

namespace vismat {
namespace {

struct Piece {
  std::array<glm::vec3, 3> corners;
  bool see_through;
};

struct Octant {
  std::string path;
  std::array<std::uint32_t, 3> place{};  // among the octants of its level
  std::vector<Piece> pieces;
};

/// The root cube, and where its parts meet.
class Cube {
 public:
  Cube(const Box& box, double scale) : low_(box.low) {
    for (unsigned axis = 0; axis < 3; ++axis)
      side_ = std::max(side_, double{box.high[axis]} - double{box.low[axis]});
    side_ *= scale;
  }
  /// The low side of the octant at `place` of `2^level` along the axis.
  float at(unsigned axis, std::uint32_t place, unsigned level) const {
    return static_cast<float>(double{low_[axis]} + side_ * place / static_cast<double>(1u << level));
  }
  Box box(const std::array<std::uint32_t, 3>& place, unsigned level) const {
    Box box;
    for (unsigned axis = 0; axis < 3; ++axis) {
      box.low[axis] = at(axis, place[axis], level);
      box.high[axis] = at(axis, place[axis] + 1, level);
    }
    return box;
  }

 private:
  std::array<float, 3> low_;
  double side_ = 0;
};

bool has_area(const Piece& piece) {
  const auto& [a, b, c] = piece.corners;
  return glm::cross(glm::dvec3(b) - glm::dvec3(a), glm::dvec3(c) - glm::dvec3(a)) != glm::dvec3(0);
}

/// Where the edge crosses the plane; the same for (a, b) and (b, a).
glm::vec3 crossing(glm::vec3 a, glm::vec3 b, int axis, float plane) {
  if (std::tie(b.x, b.y, b.z) < std::tie(a.x, a.y, a.z)) std::swap(a, b);
  const double share = (double{plane} - double{a[axis]}) / (double{b[axis]} - double{a[axis]});
  glm::vec3 point = glm::vec3(glm::mix(glm::dvec3(a), glm::dvec3(b), share));
  point[axis] = plane;
  return point;
}

/// Appends the parts of the piece below and above the plane.
void cut(const Piece& piece, int axis, float plane, std::vector<Piece>& below, std::vector<Piece>& above) {
  const auto& corners = piece.corners;
  const auto [least, most] = std::minmax({corners[0][axis], corners[1][axis], corners[2][axis]});
  if (most <= plane) return below.push_back(piece);
  if (least >= plane) return above.push_back(piece);
  std::array<std::array<glm::vec3, 4>, 2> sides;  // the polygons below and above
  std::array<unsigned, 2> count{};
  for (unsigned i = 0; i < 3; ++i) {
    const glm::vec3 &from = corners[i], &to = corners[(i + 1) % 3];
    if (from[axis] <= plane) sides[0][count[0]++] = from;
    if (from[axis] >= plane) sides[1][count[1]++] = from;
    if ((from[axis] < plane && to[axis] > plane) || (from[axis] > plane && to[axis] < plane))
      sides[0][count[0]++] = sides[1][count[1]++] = crossing(from, to, axis, plane);
  }
  for (unsigned side = 0; side < 2; ++side) {
    for (unsigned i = 2; i < count[side]; ++i) {
      const Piece part{{sides[side][0], sides[side][i - 1], sides[side][i]}, piece.see_through};
      if (has_area(part)) (side == 0 ? below : above).push_back(part);
    }
  }
}

/// The occupied eighths of the octants, of which each is at `level`; empty as soon as there are more than `most`.
std::vector<Octant> divided(const std::vector<Octant>& octants, const Cube& cube, unsigned level,
                            std::uint32_t most) {
  std::vector<Octant> eighths;
  for (const Octant& octant : octants) {
    std::array<std::vector<Piece>, 8> parts;
    parts[0] = octant.pieces;
    for (unsigned axis = 0; axis < 3; ++axis) {
      const float plane = cube.at(axis, 2 * octant.place[axis] + 1, level + 1);
      for (unsigned part = 0; part < 1u << axis; ++part) {
        const std::vector<Piece> pieces = std::exchange(parts[part], {});
        for (const Piece& piece : pieces)
          cut(piece, static_cast<int>(axis), plane, parts[part], parts[part | 1u << axis]);
      }
    }
    for (unsigned part = 0; part < 8; ++part) {
      if (parts[part].empty()) continue;
      if (eighths.size() == most) return {};
      Octant eighth{octant.path + static_cast<char>('0' + part), octant.place, std::move(parts[part])};
      for (unsigned axis = 0; axis < 3; ++axis)
        eighth.place[axis] = 2 * eighth.place[axis] + (part >> axis & 1);
      eighths.push_back(std::move(eighth));
    }
  }
  return eighths;
}

void add_object(Octants& result, const Octant& octant, bool see_through) {
  Scene& scene = result.scene;
  const std::size_t before = scene.object_of_triangle.size();
  for (const Piece& piece : octant.pieces) {
    if (piece.see_through != see_through) continue;
    for (const glm::vec3& corner : piece.corners) {
      scene.indices.push_back(static_cast<std::uint32_t>(scene.vertices.size()));
      scene.vertices.push_back(corner);
    }
    scene.object_of_triangle.push_back(scene.object_count);
  }
  if (scene.object_of_triangle.size() == before) return;
  ++scene.object_count;
  scene.see_through.push_back(see_through ? 1 : 0);
  result.octant_of_object.push_back(result.count() - 1);
}

}  // namespace

Octants cut_into_octants(const Scene& scene, std::uint32_t most, unsigned levels, double scale) {
  if (most == 0) throw std::invalid_argument("octants: at most 0; need 1 or more");
  if (levels > 20) {
    throw std::invalid_argument("octants: " + std::to_string(levels) + " levels; at most 20 can be divided");
  }
  if (!(scale >= 1 && scale <= 1e3)) throw std::invalid_argument("octants: the scale is 1 to 1000");
  std::vector<Octant> octants(1);
  Box bounds = empty_box;
  for (std::size_t t = 0; t < scene.object_of_triangle.size(); ++t) {
    const std::uint32_t object = scene.object_of_triangle[t];
    const Piece piece{corners_of(scene, t), !scene.see_through.empty() && scene.see_through[object] != 0};
    if (!has_area(piece)) continue;
    for (const glm::vec3& corner : piece.corners) grow(bounds, corner);
    octants[0].pieces.push_back(piece);
  }
  if (octants[0].pieces.empty()) throw std::invalid_argument("octants: no triangle of the scene has an area");
  const Cube cube(bounds, scale);
  Octants result;
  for (; result.levels < levels; ++result.levels) {
    std::vector<Octant> eighths = divided(octants, cube, result.levels, most);
    if (eighths.empty()) break;
    octants = std::move(eighths);
  }
  for (const Octant& octant : octants) {
    result.boxes.push_back(cube.box(octant.place, result.levels));
    result.paths.push_back(octant.path);
    for (const bool see_through : {false, true}) add_object(result, octant, see_through);
  }
  weld(result.scene);
  return result;
}

}  // namespace vismat
