// The smallest axis-aligned box around points, in double precision.
#pragma once
#include <algorithm>
#include <glm/common.hpp>
#include <glm/vec3.hpp>
#include <limits>
#include <span>

#include "matrix/box.h"

namespace vismat {

/// A box that holds no points at first.
struct Bounds {
  glm::dvec3 low{std::numeric_limits<double>::infinity()}, high{-std::numeric_limits<double>::infinity()};
};

inline void grow(Bounds& bounds, const glm::dvec3& point) {
  bounds.low = glm::min(bounds.low, point);
  bounds.high = glm::max(bounds.high, point);
}

inline Bounds bounds_of(std::span<const glm::dvec3> points) {
  Bounds bounds;
  for (const glm::dvec3& point : points) grow(bounds, point);
  return bounds;
}

/// The same box in double precision.
inline Bounds bounds_of(const Box& box) {
  return {{box.low[0], box.low[1], box.low[2]}, {box.high[0], box.high[1], box.high[2]}};
}

/// The mean of the points, of which there must be at least one.
inline glm::dvec3 middle_of(std::span<const glm::dvec3> points) {
  glm::dvec3 sum{};
  for (const glm::dvec3& point : points) sum += point - points[0];
  return points[0] + sum / static_cast<double>(points.size());
}

/// The largest absolute value of the coordinates.
inline double largest_coordinate(const glm::dvec3& point) {
  const glm::dvec3 size = glm::abs(point);
  return std::max({size.x, size.y, size.z});
}

/// Whether the two closed boxes have a point in common.
inline bool meet(const Bounds& a, const Bounds& b) {
  for (int axis = 0; axis < 3; ++axis) {
    if (!(a.low[axis] <= b.high[axis] && b.low[axis] <= a.high[axis])) return false;
  }
  return true;
}

}  // namespace vismat
