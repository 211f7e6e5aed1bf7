// ALGORITHM. All of it stands on the sign of one determinant of three differences [Shewchuk 1997, orient3d]: in doubles with
// his bound on the error, and where that leaves the sign open in GMP's rationals. His adaptive stages in between are left
// out: on scenes the bound decides all but the truly degenerate.
#include "visibility/exact/predicates.h"

#include <gmpxx.h>

#include <algorithm>
#include <cmath>

namespace vismat {
namespace {

using Exact = std::array<mpq_class, 3>;

Exact exact(const glm::dvec3& p) {
  return {mpq_class(p.x), mpq_class(p.y), mpq_class(p.z)};
}

Exact exact(const WeightedMean& mean) {
  Exact sum;
  mpq_class total;
  for (std::size_t i = 0; i < mean.points.size(); ++i) {
    const mpq_class weight(mean.weights[i]);
    const Exact point = exact(mean.points[i]);
    for (std::size_t k = 0; k < 3; ++k) sum[k] += weight * point[k];
    total += weight;
  }
  for (mpq_class& coordinate : sum) coordinate /= total;
  return sum;
}

Exact operator-(const Exact& a, const Exact& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
Exact cross(const Exact& a, const Exact& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
mpq_class dot(const Exact& a, const Exact& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

using vismat::orientation;
int orientation(const Exact& a, const Exact& b, const Exact& c, const Exact& d) {
  return sgn(dot(cross(b - a, c - a), d - a));
}

// All four points lie in one plane. What is left of the segment where it is inside each edge; t runs from 0 to 1 along it.
bool crosses_within_plane(const Exact& from, const Exact& to, const std::array<Exact, 3>& triangle) {
  const Exact normal = cross(triangle[1] - triangle[0], triangle[2] - triangle[0]);
  if (sgn(normal[0]) == 0 && sgn(normal[1]) == 0 && sgn(normal[2]) == 0) return false;
  mpq_class low = 0, high = 1;
  for (std::size_t i = 0; i < 3; ++i) {
    const Exact inward = cross(normal, triangle[(i + 1) % 3] - triangle[i]);
    const mpq_class at_from = dot(inward, from - triangle[i]), at_to = dot(inward, to - triangle[i]);
    if (at_from < 0 && at_to < 0) return false;
    if (at_from < 0) low = std::max<mpq_class>(low, at_from / (at_from - at_to));
    if (at_to < 0) high = std::min<mpq_class>(high, at_from / (at_from - at_to));
  }
  return low <= high && low < 1 && high > 0;
}

std::array<Exact, 3> exact(const Triangle& t) {
  return {exact(t[0]), exact(t[1]), exact(t[2])};
}
const std::array<Exact, 3>& exact(const std::array<Exact, 3>& t) {
  return t;
}
const Exact& exact(const Exact& p) {
  return p;
}

template <typename Point>
bool crosses_triangle(const Point& from, const Point& to, const std::array<Point, 3>& t) {
  const int at_from = orientation(t[0], t[1], t[2], from), at_to = orientation(t[0], t[1], t[2], to);
  if (at_from == 0 && at_to == 0) return from != to && crosses_within_plane(exact(from), exact(to), exact(t));
  if (at_from * at_to >= 0) return false;
  int sides = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const int side = orientation(from, to, t[i], t[(i + 1) % 3]);
    if (side * sides < 0) return false;
    if (side != 0) sides = side;
  }
  return true;
}

template <typename Visit>  // false from `visit` ends it
bool each_fan_triangle(const Convex& convex, Visit&& visit) {
  for (const Convex::Face& face : convex.faces) {
    for (std::size_t i = 1; i + 1 < face.corners.size(); ++i) {
      if (!visit(Triangle{convex.vertices[face.corners[0]], convex.vertices[face.corners[i]],
                          convex.vertices[face.corners[i + 1]]})) {
        return false;
      }
    }
  }
  return true;
}

}  // namespace

int orientation(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const glm::dvec3& d) {
  const glm::dvec3 u = b - a, v = c - a, w = d - a;
  const double xy = u.x * v.y, yx = u.y * v.x, yz = u.y * v.z, zy = u.z * v.y, zx = u.z * v.x, xz = u.x * v.z;
  const double determinant = w.z * (xy - yx) + w.x * (yz - zy) + w.y * (zx - xz);
  const double magnitude = std::abs(w.z) * (std::abs(xy) + std::abs(yx)) +
                           std::abs(w.x) * (std::abs(yz) + std::abs(zy)) +
                           std::abs(w.y) * (std::abs(zx) + std::abs(xz));
  // Shewchuk's factor is 7.8e-16; the constant stands for what underflows. An overflow compares false.
  const double error = 1e-15 * magnitude + 1e-290;
  if (determinant > error && magnitude < INFINITY) return 1;
  if (determinant < -error && magnitude < INFINITY) return -1;
  return orientation(exact(a), exact(b), exact(c), exact(d));
}

bool crosses(const glm::dvec3& from, const glm::dvec3& to, const Triangle& triangle) {
  return crosses_triangle(from, to, triangle);
}

bool crosses(const glm::dvec3& from, const glm::dvec3& to, const Convex& convex) {
  return !each_fan_triangle(convex, [&](const Triangle& t) { return !crosses(from, to, t); });
}

std::size_t first_crossed(const WeightedMean& from, const WeightedMean& to,
                          std::span<const Triangle> triangles) {
  const auto first = [&](const auto& crossed) {
    return static_cast<std::size_t>(std::find_if(triangles.begin(), triangles.end(), crossed) -
                                    triangles.begin());
  };
  if (from.points.size() == 1 && to.points.size() == 1) {
    return first([&](const Triangle& t) { return crosses(from.points[0], to.points[0], t); });
  }
  const Exact a = exact(from), b = exact(to);
  return first([&](const Triangle& t) { return crosses_triangle(a, b, exact(t)); });
}

bool hides(const Convex& convex, std::span<const glm::dvec3> a, std::span<const glm::dvec3> b) {
  for (const glm::dvec3& w : a) {
    for (const glm::dvec3& x : b) {
      if (!crosses(w, x, convex)) return false;
    }
  }
  return true;
}

bool beyond_a_face(const Convex& solid, std::span<const glm::dvec3> points, bool strictly) {
  return !each_fan_triangle(solid, [&](const Triangle& t) {
    const auto side = [&](const glm::dvec3& p) { return orientation(t[0], t[1], t[2], p); };
    const bool beyond = std::all_of(points.begin(), points.end(),
                                    [&](const glm::dvec3& p) { return side(p) >= (strictly ? 1 : 0); });
    // Where a fan's triangle has no area every point is on its plane.
    return !beyond || std::none_of(solid.vertices.begin(), solid.vertices.end(),
                                   [&](const glm::dvec3& p) { return side(p) < 0; });
  });
}

bool meets(const Triangle& triangle, const Convex& solid) {
  std::vector<Exact> polygon = {exact(triangle[0]), exact(triangle[1]), exact(triangle[2])};
  for (const Convex::Face& face : solid.faces) {
    const Exact normal = exact(face.normal);
    const mpq_class offset(face.offset);
    std::vector<Exact> kept;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const Exact &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
      const mpq_class at_a = dot(normal, a) - offset, at_b = dot(normal, b) - offset;
      if (at_a <= 0) kept.push_back(a);
      if (at_a * at_b < 0) {
        const mpq_class t = at_a / (at_a - at_b);
        const Exact along = b - a;
        kept.push_back({a[0] + t * along[0], a[1] + t * along[1], a[2] + t * along[2]});
      }
    }
    polygon = std::move(kept);
    if (polygon.empty()) return false;
  }
  return true;
}

std::vector<Triangle> triangles_of(const Convex& convex) {
  std::vector<Triangle> triangles;
  each_fan_triangle(convex, [&](const Triangle& t) {
    triangles.push_back(t);
    return true;
  });
  return triangles;
}

}  // namespace vismat
