// ALGORITHM. Polygons are cut into triangles by ears: a corner that turns left and whose triangle no other corner touches is cut
// off, in the plane of the polygon's Newell normal. Corners on a straight line wait until they end a proper triangle, so
// that no triangle without area stands for a neighbour's vertex on the edge. A polygon that crosses itself is cut anyhow.
#include "visibility/meshes/polygons.h"

#include <algorithm>
#include <cstdio>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <span>
#include <utility>

#include "matrix/base/byte_reader.h"

namespace vismat {
namespace {

constexpr std::size_t most_corners = 4096;

class EarCutter {
 public:
  void cut(std::span<const std::uint32_t> polygon, const std::vector<glm::vec3>& points,
           std::vector<std::uint32_t>& triangles) {
    flatten(polygon, points);
    left_.resize(polygon.size());
    for (std::size_t i = 0; i < left_.size(); ++i) left_[i] = static_cast<std::uint32_t>(i);
    std::size_t at = 0, failed = 0;
    while (left_.size() > 3) {
      const std::size_t size = left_.size(), before = (at + size - 1) % size, after = (at + 1) % size;
      // One that crosses itself, or is flat, has no ears left: then any corner will do.
      if (failed == size || is_ear(left_[before], left_[at], left_[after])) {
        for (const std::size_t i : {before, at, after}) triangles.push_back(polygon[left_[i]]);
        left_.erase(left_.begin() + static_cast<std::ptrdiff_t>(at));
        at = at == size - 1 ? 0 : at;
        failed = 0;
      } else {
        at = after;
        ++failed;
      }
    }
    for (const std::uint32_t i : left_) triangles.push_back(polygon[i]);
  }

 private:
  void flatten(std::span<const std::uint32_t> polygon, const std::vector<glm::vec3>& points) {
    glm::dvec3 normal(0);
    const glm::dvec3 origin = points[polygon[0]];
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      normal += glm::cross(glm::dvec3(points[polygon[i]]) - origin,
                           glm::dvec3(points[polygon[(i + 1) % polygon.size()]]) - origin);
    }
    int axis = 0;  // along which the polygon looks largest
    for (const int other : {1, 2}) {
      if (std::abs(normal[other]) > std::abs(normal[axis])) axis = other;
    }
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    flat_.clear();
    for (const std::uint32_t point : polygon) {
      const glm::dvec3 place = points[point];
      flat_.emplace_back(place[u], normal[axis] < 0 ? -place[v] : place[v]);
    }
  }
  double turn(std::size_t a, std::size_t b, std::size_t c) const {
    const glm::dvec2 ab = flat_[b] - flat_[a], ac = flat_[c] - flat_[a];
    return ab.x * ac.y - ab.y * ac.x;
  }
  bool is_ear(std::size_t a, std::size_t b, std::size_t c) const {
    if (!(turn(a, b, c) > 0)) return false;
    return std::none_of(left_.begin(), left_.end(), [&](std::uint32_t i) {
      if (flat_[i] == flat_[a] || flat_[i] == flat_[b] || flat_[i] == flat_[c]) return false;
      return turn(a, b, i) >= 0 && turn(b, c, i) >= 0 && turn(c, a, i) >= 0;
    });
  }
  std::vector<glm::dvec2> flat_;
  std::vector<std::uint32_t> left_;
};

}  // namespace

Scene Polygons::take() {
  Scene scene;
  if (points_.empty()) throw FormatError("holds no points");
  leave_out_unplaced();
  EarCutter cutter;
  for (std::size_t face = 0; face < where_.size(); ++face) {
    const std::size_t end = face + 1 < where_.size() ? first_corner_[face + 1] : corners_.size();
    const std::span<const std::uint32_t> corners =
        std::span(corners_).subspan(first_corner_[face], end - first_corner_[face]);
    for (const std::uint32_t corner : corners) {
      if (corner >= points_.size()) {
        fail(face, "names a point that is not among the " + std::to_string(points_.size()) + " of the file");
      }
    }
    if (corners.empty()) fail(face, "a face without corners");
    if (corners.size() > most_corners) {
      fail(face, "a face of " + std::to_string(corners.size()) + " corners; at most 4096 are read");
    }
    if (corners.size() > 3) {
      cutter.cut(corners, points_, scene.indices);
    } else {
      for (std::size_t i = 0; i < 3; ++i) scene.indices.push_back(corners[std::min(i, corners.size() - 1)]);
    }
    if (scene.indices.size() / 3 > most_points) fail(face, "more than 4294967294 triangles");
  }
  if (scene.indices.empty())
    throw FormatError("holds " + std::to_string(points_.size()) + " points but no faces");
  scene.vertices = std::move(points_);
  scene.object_of_triangle.assign(scene.indices.size() / 3, 0);
  scene.object_count = 1;
  return scene;
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
