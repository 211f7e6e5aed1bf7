// Geometry in the plane: cross products and convex hulls.
#pragma once
#include <algorithm>
#include <cstddef>
#include <glm/vec2.hpp>
#include <tuple>
#include <vector>

namespace vismat {

/// The cross product, which is above 0 if b points to the left of a.
inline double cross(const glm::dvec2& a, const glm::dvec2& b) {
  return a.x * b.y - a.y * b.x;
}

/// The corners of the points' convex hull in the xy plane, counter-clockwise from the least (x, y), none of them on a
/// line between others; fewer than three if the hull has no area. `turn(a, b, c)` is above 0 if the way a, b, c turns
/// left at b. The caller gives it, since turns that are rounded in different ways keep different corners of nearly
/// straight sides. Monotone chain [Andrew 1979]; O(n log n).
template <typename Point, typename Turn>
std::vector<Point> convex_hull(std::vector<Point> points, const Turn& turn) {
  std::sort(points.begin(), points.end(),
            [](const Point& a, const Point& b) { return std::tie(a.x, a.y) < std::tie(b.x, b.y); });
  std::vector<Point> hull;
  for (int half = 0; half < 2 && !points.empty(); ++half) {  // below and above
    const std::size_t first = hull.size();
    for (const Point& p : points) {
      while (hull.size() >= first + 2 && turn(hull[hull.size() - 2], hull.back(), p) <= 0) hull.pop_back();
      hull.push_back(p);
    }
    hull.pop_back();
    std::reverse(points.begin(), points.end());
  }
  return hull;
}

}  // namespace vismat
