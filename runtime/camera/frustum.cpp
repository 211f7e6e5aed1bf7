#include "runtime/camera/frustum.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "visibility/geometry/point_bounds.h"

namespace vismat {
namespace {

/// The camera's axes in the scene, and the picture at distance 1.
struct View {
  glm::dvec3 right, up, ahead;
  double half_width, half_height;
};

View view_of(const Pose& pose, const Screen& screen) {
  pixels_per_radian(screen);  // refuses what is no screen
  const glm::dmat3 axes = glm::mat3_cast(glm::normalize(pose.rotation));
  const double half = std::tan(double{screen.field_of_view} * std::numbers::pi / 360);
  return {axes[0], axes[1], -axes[2], half, half * screen.height / screen.width};
}

}  // namespace

Frustum::Frustum(const Pose& pose, const Screen& screen, double near)
    : position_(pose.position), near_(near) {
  if (!(near >= 0 && near <= 1e9)) throw std::invalid_argument("a near plane is 0 to 1e9 m from the camera");
  const View view = view_of(pose, screen);
  const double w = view.half_width, h = view.half_height;
  inward_ = {glm::normalize(view.right + view.ahead * w), glm::normalize(-view.right + view.ahead * w),
             glm::normalize(-view.up + view.ahead * h), glm::normalize(view.up + view.ahead * h), view.ahead};
  constexpr double infinity = std::numeric_limits<double>::infinity();
  low_ = glm::dvec3(infinity);
  high_ = glm::dvec3(-infinity);
  largest_ = largest_coordinate(position_);
  for (const double x : {-w, w}) {
    for (const double y : {-h, h}) {
      const glm::dvec3 ray = view.ahead + view.right * x + view.up * y, corner = position_ + ray * near;
      largest_ = std::max(largest_, largest_coordinate(corner));
      for (int axis = 0; axis < 3; ++axis) {
        // Rays that run along the axis only by their rounding have no end either.
        const double rounding = 1e-12 * (1 + w + h);
        low_[axis] = std::min(low_[axis], ray[axis] < rounding ? -infinity : corner[axis]);
        high_[axis] = std::max(high_[axis], ray[axis] > -rounding ? infinity : corner[axis]);
      }
    }
  }
}

bool Frustum::meets(const Box& box) const {
  const Bounds bounds = bounds_of(box);
  const double least = -slack(std::max(largest_coordinate(bounds.low), largest_coordinate(bounds.high)));
  for (int axis = 0; axis < 3; ++axis) {
    if (bounds.high[axis] - low_[axis] < least || high_[axis] - bounds.low[axis] < least) return false;
  }
  const glm::dvec3 low = bounds.low - position_, high = bounds.high - position_;
  for (std::size_t plane = 0; plane < inward_.size(); ++plane) {
    const glm::dvec3& inward = inward_[plane];
    double farthest = plane == 4 ? -near_ : 0;  // of the box's corners, from the plane
    for (int axis = 0; axis < 3; ++axis) farthest += inward[axis] * (inward[axis] > 0 ? high : low)[axis];
    if (farthest < least) return false;
  }
  return true;
}

bool Frustum::contains(const glm::dvec3& point) const {
  const double least = -slack(largest_coordinate(point));
  const glm::dvec3 from = point - position_;
  for (std::size_t plane = 0; plane < inward_.size(); ++plane) {
    if (glm::dot(inward_[plane], from) - (plane == 4 ? near_ : 0) < least) return false;
  }
  return true;
}

PixelRays::PixelRays(const Pose& pose, const Screen& screen) {
  const View view = view_of(pose, screen);
  const double pixel = 2 * view.half_width / screen.width;
  right_ = view.right * pixel;
  down_ = -view.up * pixel;
  first_ = view.ahead + right_ * (0.5 - screen.width / 2.0) + down_ * (0.5 - screen.height / 2.0);
}

glm::dvec3 PixelRays::operator()(double x, double y) const {
  return glm::normalize(first_ + right_ * x + down_ * y);
}

}  // namespace vismat
