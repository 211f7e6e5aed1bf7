#include "visibility/meshes/polygons.h"

#include <span>
#include <utility>

#include "matrix/base/byte_reader.h"
#include "visibility/meshes/triangulation.h"

namespace vismat {
namespace {

constexpr std::size_t most_corners = 4096;

}  // namespace

Scene Polygons::take() {
  Scene scene;
  if (points_.empty()) throw FormatError("holds no points");
  Triangulator triangulator;
  const std::size_t in_file = points_.size();  // crossings of outlines follow
  for (std::size_t face = 0; face < where_.size(); ++face) {
    const std::size_t end = face + 1 < where_.size() ? first_corner_[face + 1] : corners_.size();
    const std::span<const std::uint32_t> corners =
        std::span(corners_).subspan(first_corner_[face], end - first_corner_[face]);
    for (const std::uint32_t corner : corners) {
      if (corner >= in_file) {
        fail(face, "names a point that is not among the " + std::to_string(in_file) + " of the file");
      }
    }
    if (corners.empty()) fail(face, "a face without corners");
    if (corners.size() > most_corners) {
      fail(face, "a face of " + std::to_string(corners.size()) + " corners; at most 4096 are read");
    }
    if (corners.size() > 3) {
      triangulator.add(corners, points_, scene.indices);
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

void Polygons::fail(std::size_t face, const std::string& what) const {
  throw FormatError(std::string(place_) + " " + std::to_string(where_[face]) + ": " + what);
}

}  // namespace vismat
