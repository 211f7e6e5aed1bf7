// Collects the points and polygons of a mesh file, and cuts the polygons into triangles.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "visibility/meshes/mesh_file.h"
#include "visibility/meshes/text.h"
#include "visibility/scene.h"

namespace vismat {

inline constexpr std::uint64_t most_points = 0xfffffffe;  // and triangles
inline constexpr double farthest_point = 1e9;

/// The vertices and faces that the reader of each format fills in.
class Polygons {
 public:
  /// `place` names faces in messages: "line" if begin_face is given lines, "face" if it is given numbers.
  /// `point_place` does so for points: "the point of line" or "point".
  explicit Polygons(const char* place, const char* point_place = "the point of line")
      : place_(place), point_place_(point_place) {}

  template <typename Fail>
  void add_point(const std::array<double, 3>& at, const Fail& fail) {
    if (points_.size() == most_points) fail("more than 4294967294 points");
    for (const double x : at) {
      if (!(std::abs(x) <= farthest_point)) fail("a coordinate is not a number within 1e9 of the origin");
    }
    points_.emplace_back(at[0], at[1], at[2]);
  }
  /// Like add_point for a point that may be anywhere as long as no face uses it; see take(). `where` is its line or number.
  template <typename Fail>
  void add_point(const Coordinates& point, std::uint64_t where, const Fail& fail) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (std::abs(point.at[axis]) <= farthest_point) continue;
      unplaced_.push_back({points_.size(), where, shown(point.at[axis], point.words[axis])});
      return add_point({0, 0, 0}, fail);
    }
    add_point(point.at, fail);
  }
  std::size_t points() const { return points_.size(); }

  /// What the following faces belong to.
  void begin_part(MeshPart part);
  void begin_face(std::uint64_t where) {
    where_.push_back(where);
    first_corner_.push_back(corners_.size());
    part_of_face_.push_back(part_);
  }
  /// `point` counts from 0; it may be a point that is added later.
  void add_corner(std::uint64_t point) {
    corners_.push_back(static_cast<std::uint32_t>(std::min(point, most_points)));
  }

  /// How many points take() leaves out because a coordinate is not a number within 1e9 of the origin.
  std::size_t unplaced() const { return unplaced_.size(); }
  /// Fills in the scene, its parts and its origin, without the points that are unplaced. Throws FormatError if a face names
  /// points that do not exist or are unplaced, if there are no faces, and so on.
  void take(const MeshPlacement& placement, MeshFile& file);

 private:
  struct Unplaced {
    std::uint64_t point, where;
    std::string word;  // for the message
  };
  static std::string shown(double number, std::string_view word);
  void leave_out_unplaced();
  std::vector<glm::vec3> placed(const MeshPlacement& placement, std::array<double, 3>& origin) const;
  [[noreturn]] void fail(std::size_t face, const std::string& what) const;
  const char* place_;
  const char* point_place_;
  std::vector<glm::dvec3> points_;
  std::vector<std::uint32_t> corners_;
  std::vector<std::uint64_t> first_corner_, where_;
  std::vector<std::uint32_t> part_of_face_;
  std::vector<MeshPart> parts_{{}};
  std::map<std::pair<std::string, std::string>, std::uint32_t> number_of_part_{{{"", ""}, 0}};
  std::uint32_t part_ = 0;
  std::vector<Unplaced> unplaced_;  // ascending
};

}  // namespace vismat
