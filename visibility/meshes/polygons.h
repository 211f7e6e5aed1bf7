// Collects the points and polygons of a mesh file, and cuts the polygons into triangles.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "visibility/scene.h"

namespace vismat {

inline constexpr std::uint64_t most_points = 0xfffffffe;  // and triangles
inline constexpr double farthest_point = 1e9;

/// The vertices and faces that the reader of each format fills in.
class Polygons {
 public:
  /// `place` names faces in messages: "line" if begin_face is given lines, "face" if it is given numbers.
  explicit Polygons(const char* place) : place_(place) {}

  template <typename Fail>
  void add_point(const std::array<double, 3>& at, const Fail& fail) {
    if (points_.size() == most_points) fail("more than 4294967294 points");
    for (const double x : at) {
      if (!(std::abs(x) <= farthest_point)) fail("a coordinate is not a number within 1e9 of the origin");
    }
    points_.emplace_back(at[0], at[1], at[2]);
  }
  std::size_t points() const { return points_.size(); }

  void begin_face(std::uint64_t where) {
    where_.push_back(where);
    first_corner_.push_back(corners_.size());
  }
  /// `point` counts from 0; it may be a point that is added later.
  void add_corner(std::uint64_t point) {
    corners_.push_back(static_cast<std::uint32_t>(std::min(point, most_points)));
  }

  /// The scene, with one object. Throws FormatError if a face names points that do not exist, if there are no faces,
  /// and so on.
  Scene take();

 private:
  [[noreturn]] void fail(std::size_t face, const std::string& what) const;
  const char* place_;
  std::vector<glm::vec3> points_;
  std::vector<std::uint32_t> corners_;
  std::vector<std::uint64_t> first_corner_, where_;
};

}  // namespace vismat
