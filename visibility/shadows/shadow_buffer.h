// A depth buffer all around a point, which decides whether a box lies behind the shrunk occluders that are drawn in it.
#pragma once
#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "visibility/geometry/convex.h"
#include "visibility/shadows/supporting_planes.h"

namespace vismat {

/// Six square faces of a cube around a projection point, with `resolution` pixels along a side and 4 bytes for each
/// pixel. A shape that is drawn covers only pixels that lie wholly inside it, at its farthest depth in the pixel; a box
/// that is tested is looked up in every pixel that it touches, at its nearest depth. So rounding can lose an occlusion
/// but never invent one.
class ShadowBuffer {
 public:
  explicit ShadowBuffer(std::uint32_t resolution);  // a power of two, 16 to 4096; std::invalid_argument

  /// Starts anew from `point`, with nothing hidden. With `names`, the name of what each pixel shows is kept too.
  void clear(const glm::dvec3& point, bool names = false);
  /// Draws the part of a solid that lies within the cone from the point that is bounded by the directions of `planes`
  /// ([Chhugani et al. 2005, section 5.2]: the occluder clipped to the frustum with planes parallel to its supporting
  /// planes). The point lies outside the solid. Returns whether a pixel was covered.
  bool draw(const Convex& shape, std::span<const Plane> planes, std::uint32_t name = 0);
  /// Whether every point of the box lies behind what was drawn.
  bool hides(const Box& box) const;
  /// Adds the names of what covers the box, in all pixels that it touches, each once.
  void names_before(const Box& box, std::vector<std::uint32_t>& names) const;

 private:
  struct Face {
    std::vector<float> nearness;  // 1 / depth of what is drawn, 0 where nothing is
    std::vector<std::uint32_t> names;
    std::uint32_t first_row = 0, end_row = 0;  // rows with anything drawn
  };
  template <typename Visit>
  bool touched_pixels(const Box& box, const Visit& visit) const;

  std::uint32_t resolution_;
  double pixel_;
  glm::dvec3 point_{};
  bool named_ = false;
  std::array<Face, 6> faces_;
};

}  // namespace vismat
