// What a camera's picture shows: the space that it takes in, and the ray of each pixel.
#pragma once
#include <array>
#include <glm/vec3.hpp>

#include "matrix/box.h"
#include "runtime/camera/camera_path.h"
#include "visibility/detail/levels_of_detail.h"

namespace vismat {

/// The space in front of the near plane that the picture shows; it has no far plane.
class Frustum {
 public:
  /// `near` is the distance of the near plane in metres, 0 or more. Throws std::invalid_argument for a screen without
  /// pixels, a field of view out of range, or another `near`.
  Frustum(const Pose& pose, const Screen& screen, double near);

  /// False only if no point of the closed box is inside. True for a few boxes outside, beside an edge of the frustum: what it
  /// tests are its five planes and the box's six, not the edges of both.
  bool meets(const Box& box) const;
  /// Whether the point is inside or, by rounding, as good as there: within 1e-12 of the size of the coordinates.
  bool contains(const glm::dvec3& point) const;

 private:
  double slack(double reach) const { return 1e-12 * (reach + largest_); }

  glm::dvec3 position_;
  double largest_;                    // of the coordinates of all that is below, absolute
  std::array<glm::dvec3, 5> inward_;  // unit normals: left, right, top, bottom, near
  double near_;
  glm::dvec3 low_, high_;  // of all that is inside; infinite where it has no end
};

/// The rays of a picture's pixels. A pixel's area reaches half a pixel to each side of its middle.
class PixelRays {
 public:
  /// Throws as Frustum does.
  PixelRays(const Pose& pose, const Screen& screen);
  /// The direction, of unit length in the scene's axes, of the ray from the camera through the middle of pixel (x, y), x from
  /// the left and y from the top; x + 0.5 is its right border. Points seen through any pixel of the screen, beyond the near
  /// plane, are in the Frustum of the same pose and screen.
  glm::dvec3 operator()(double x, double y) const;

 private:
  glm::dvec3 first_, right_, down_;  // to the middle of pixel (0, 0), and from pixel to pixel
};

}  // namespace vismat
