#include "visibility/meshes/polygons.h"

#include <algorithm>
#include <cstdio>
#include <limits>
#include <span>
#include <utility>

#include "matrix/base/byte_reader.h"
#include "visibility/meshes/triangulation.h"

namespace vismat {
namespace {

constexpr std::size_t most_corners = 4096;

}  // namespace

void Polygons::begin_part(MeshPart part) {
  const auto [found, is_new] =
      number_of_part_.try_emplace({part.group, part.material}, static_cast<std::uint32_t>(parts_.size()));
  part_ = found->second;
  if (is_new) parts_.push_back(std::move(part));
}

/// The points as the scene has them. A model whose middle lies farther from 0 than 8 km and than its own size, along an axis, is
/// moved by whole kilometres unless the origin is given: there floats are a millimetre apart and more.
std::vector<glm::vec3> Polygons::placed(const MeshPlacement& placement, std::array<double, 3>& origin) const {
  constexpr double far = 8192, step = 1000;
  const auto in_metres = [&](const glm::dvec3& p) {
    return (placement.y_up ? glm::dvec3(p.x, -p.z, p.y) : p) * double{placement.scale};
  };
  std::array<double, 3> low, high;
  low.fill(std::numeric_limits<double>::infinity()), high.fill(-std::numeric_limits<double>::infinity());
  for (const std::uint32_t corner : corners_) {
    const glm::dvec3 at = in_metres(points_[corner]);
    for (unsigned axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], at[static_cast<int>(axis)]);
      high[axis] = std::max(high[axis], at[static_cast<int>(axis)]);
    }
  }
  origin = placement.origin.value_or(std::array<double, 3>{});
  for (unsigned axis = 0; axis < 3; ++axis) {
    const double middle = (low[axis] + high[axis]) / 2;
    if (!placement.origin && std::abs(middle) > std::max(far, high[axis] - low[axis])) {
      origin[axis] = std::round(middle / step) * step;
    }
    for (const double end : {low[axis], high[axis]}) {
      if (std::abs(end - origin[axis]) > farthest_point)
        throw FormatError("a coordinate is farther than 1e9 m from the origin");
    }
  }
  std::vector<glm::vec3> result(points_.size());
  for (std::size_t i = 0; i < points_.size(); ++i) {
    result[i] = in_metres(points_[i]) - glm::dvec3(origin[0], origin[1], origin[2]);
  }
  return result;
}

void Polygons::take(const MeshPlacement& placement, MeshFile& file) {
  Scene& scene = file.scene;
  if (points_.empty()) throw FormatError("holds no points");
  const std::size_t in_file = points_.size();
  leave_out_unplaced();
  const auto corners_of_face = [&](std::size_t face) {
    const std::size_t end = face + 1 < where_.size() ? first_corner_[face + 1] : corners_.size();
    return std::span(corners_).subspan(first_corner_[face], end - first_corner_[face]);
  };
  for (std::size_t face = 0; face < where_.size(); ++face) {
    const auto corners = corners_of_face(face);
    for (const std::uint32_t corner : corners) {
      if (corner >= points_.size()) {
        fail(face, "names a point that is not among the " + std::to_string(in_file) + " of the file");
      }
    }
    if (corners.empty()) fail(face, "a face without corners");
    if (corners.size() > most_corners) {
      fail(face, "a face of " + std::to_string(corners.size()) + " corners; at most 4096 are read");
    }
  }
  if (where_.empty()) throw FormatError("holds " + std::to_string(in_file) + " points but no faces");
  scene.vertices = placed(placement, file.origin);
  std::vector<std::uint32_t> object_of_part(parts_.size(), most_points);
  Triangulator triangulator;
  for (std::size_t face = 0; face < where_.size(); ++face) {
    const auto corners = corners_of_face(face);
    if (corners.size() > 3) {
      triangulator.add(corners, scene.vertices, scene.indices);
    } else {
      for (std::size_t i = 0; i < 3; ++i) scene.indices.push_back(corners[std::min(i, corners.size() - 1)]);
    }
    if (scene.indices.size() / 3 > most_points) fail(face, "more than 4294967294 triangles");
    std::uint32_t& object = object_of_part[part_of_face_[face]];
    if (object == most_points) {
      object = static_cast<std::uint32_t>(file.parts.size());
      file.parts.push_back(parts_[part_of_face_[face]]);
    }
    scene.object_of_triangle.resize(scene.indices.size() / 3, object);
  }
  scene.object_count = static_cast<std::uint32_t>(file.parts.size());
}

std::string Polygons::shown(double number, std::string_view word) {
  if (!word.empty()) return vismat::shown(word);
  char text[32];
  std::snprintf(text, sizeof text, "%g", number);
  return text;
}

void Polygons::leave_out_unplaced() {
  if (unplaced_.empty()) return;
  constexpr std::uint32_t nowhere = 0xffffffff;
  std::vector<std::uint32_t> new_of_old(points_.size());
  for (const Unplaced& point : unplaced_) new_of_old[point.point] = nowhere;
  std::uint32_t kept = 0;
  for (std::uint32_t& point : new_of_old) {
    if (point != nowhere) point = kept++;
  }
  for (std::size_t i = 0; i < corners_.size(); ++i) {
    if (corners_[i] >= points_.size()) return;  // which take() refuses
    if (new_of_old[corners_[i]] != nowhere) continue;
    const auto point = std::ranges::lower_bound(unplaced_, corners_[i], {}, &Unplaced::point);
    const auto face =
        std::upper_bound(first_corner_.begin(), first_corner_.end(), i) - first_corner_.begin() - 1;
    fail(static_cast<std::size_t>(face), std::string("uses ") + point_place_ + " " +
                                             std::to_string(point->where) + ", where " + point->word +
                                             " is not a number within 1e9 of the origin");
  }
  for (std::uint32_t& corner : corners_) corner = new_of_old[corner];
  for (std::size_t point = 0; point < points_.size(); ++point) {
    if (new_of_old[point] != nowhere) points_[new_of_old[point]] = points_[point];
  }
  points_.resize(kept);
}

void Polygons::fail(std::size_t face, const std::string& what) const {
  throw FormatError(std::string(place_) + " " + std::to_string(where_[face]) + ": " + what);
}

}  // namespace vismat
