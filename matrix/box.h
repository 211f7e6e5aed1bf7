// An axis-aligned box around a view cell or an object, and what is often asked of such boxes.
#pragma once
#include <algorithm>
#include <array>
#include <limits>

namespace vismat {

/// An axis-aligned box, in the scene's units.
struct Box {
  std::array<float, 3> low{}, high{};
  bool operator==(const Box&) const = default;
};

/// The box around no points. Once grown by a point, it is the box of that point.
inline constexpr Box empty_box = {
    {std::numeric_limits<float>::infinity(), std::numeric_limits<float>::infinity(),
     std::numeric_limits<float>::infinity()},
    {-std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity(),
     -std::numeric_limits<float>::infinity()}};

/// Grows the box just enough to hold the point, whose three coordinates are floats that [] gives.
template <typename Point>
void grow(Box& box, const Point& point) {
  for (int axis = 0; axis < 3; ++axis) {
    box.low[axis] = std::min(box.low[axis], point[axis]);
    box.high[axis] = std::max(box.high[axis], point[axis]);
  }
}

/// The same box, but [0, 0] instead of empty_box: what has no place is stored with that box.
inline Box zero_if_empty(const Box& box) {
  return box.low[0] > box.high[0] ? Box{} : box;
}

/// The smallest box around both.
inline Box box_around(Box a, const Box& b) {
  for (int axis = 0; axis < 3; ++axis) {
    a.low[axis] = std::min(a.low[axis], b.low[axis]);
    a.high[axis] = std::max(a.high[axis], b.high[axis]);
  }
  return a;
}

/// The centre of the box. Never overflows.
inline std::array<float, 3> centre_of(const Box& box) {
  std::array<float, 3> centre;
  for (int axis = 0; axis < 3; ++axis) centre[axis] = box.low[axis] / 2 + box.high[axis] / 2;
  return centre;
}

/// Whether the two closed boxes have a point in common.
inline bool meet(const Box& a, const Box& b) {
  for (int axis = 0; axis < 3; ++axis) {
    if (!(a.low[axis] <= b.high[axis] && b.low[axis] <= a.high[axis])) return false;
  }
  return true;
}

}  // namespace vismat
