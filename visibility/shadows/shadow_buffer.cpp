// ALGORITHM. Seen from the projection point a convex solid is a cone, bounded by one plane through the point for each
// edge of its outline; the frustum that shrinks it [Chhugani et al. 2005, section 5.2] is bounded by planes through the
// point as well. So the shrunk occluder's picture on a face of the cube is an intersection of half-planes, found
// without clipping a polygon in space and without a near plane, and its nearness (1 / depth) is the least of its lit
// faces' nearnesses, each linear over the face. A row of pixels is then an interval, cut by each half-plane at the
// pixel's worst corner. No border of the cube is drawn or clipped against: a pixel at the border is covered if the cone
// covers it, so the faces join without a seam.
#include "visibility/shadows/shadow_buffer.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

namespace vismat {
namespace {

/// How far a direction must stay inside a plane, as a sine: far above the error of a plane's normal, far below a pixel.
constexpr double margin = 1e-8;

/// A function over a face of the cube: at (x, y) in [-1, 1]^2 its value is x * u + y * v + w.
struct Linear {
  double u, v, w;
  double inverse = 0;  // of u, of a half-plane that cuts rows
};
Linear on_face(unsigned face, const glm::dvec3& k) {
  const int axis = static_cast<int>(face / 2);
  return {k[(axis + 1) % 3], k[(axis + 2) % 3], face % 2 ? k[axis] : -k[axis], 0};
}

/// The part of a face that lies in some half-planes, as bounds; less than 34 corners however many half-planes.
class Window {
  using Corner = std::array<double, 2>;

 public:
  Window() {
    for (const auto& [x, y] : {std::pair{-1.0, -1.0}, {1.0, -1.0}, {1.0, 1.0}, {-1.0, 1.0}})
      corners_[count_++] = {x, y};
  }
  /// False if nothing is left.
  bool cut(const Linear& side) {
    Corner kept[most];
    unsigned count = 0;
    for (unsigned i = 0; i < count_; ++i) {
      const auto &a = corners_[i], &b = corners_[i + 1 == count_ ? 0 : i + 1];
      const double at_a = a[0] * side.u + a[1] * side.v + side.w,
                   at_b = b[0] * side.u + b[1] * side.v + side.w;
      if (at_a >= 0) kept[count++] = a;
      if ((at_a >= 0) != (at_b >= 0)) {
        const double t = at_a / (at_a - at_b);
        kept[count++] = {a[0] + (b[0] - a[0]) * t, a[1] + (b[1] - a[1]) * t};
      }
      if (count + 2 > most) return true;  // bounds of what was left before are bounds still
    }
    std::copy_n(kept, count, corners_);
    count_ = count;
    return count_ > 0;
  }
  std::array<double, 2> bounds(unsigned axis) const {
    std::array<double, 2> bounds = {1, -1};
    for (unsigned i = 0; i < count_; ++i) {
      bounds[0] = std::min(bounds[0], corners_[i][axis]);
      bounds[1] = std::max(bounds[1], corners_[i][axis]);
    }
    return bounds;
  }

 private:
  static constexpr unsigned most = 32;
  Corner corners_[most];
  unsigned count_ = 0;
};

/// Planes through the point along the outline that a solid shows it, and those of its lit faces as nearness over direction:
/// dot(near, d) = 1 / depth along d. False if the point is not outside.
struct Outline {
  std::vector<glm::dvec3> sides, nearness;
  std::vector<char> lit;

  bool trace(const Convex& shape, const glm::dvec3& point) {
    sides.clear();
    nearness.clear();
    lit.assign(shape.faces.size(), 0);
    for (std::size_t i = 0; i < shape.faces.size(); ++i) {
      const double height = glm::dot(shape.faces[i].normal, point) - shape.faces[i].offset;
      if (!(height > 0)) continue;
      lit[i] = 1;
      nearness.push_back(shape.faces[i].normal / -height);
    }
    if (nearness.empty()) return false;
    for (const Convex::Edge& edge : shape.edges) {
      if (lit[edge.faces[0]] == lit[edge.faces[1]]) continue;
      const unsigned first = lit[edge.faces[0]] ? 0 : 1;
      const glm::dvec3 side =
          glm::cross(shape.vertices[edge.ends[1 - first]] - point, shape.vertices[edge.ends[first]] - point);
      if (const double length = glm::length(side); length > 0) sides.push_back(side / length);
    }
    return true;
  }
};

}  // namespace

ShadowBuffer::ShadowBuffer(std::uint32_t resolution) : resolution_(resolution), pixel_(2.0 / resolution) {
  if (!std::has_single_bit(resolution) || resolution < 16 || resolution > 4096) {
    throw std::invalid_argument("shadow buffer: resolution " + std::to_string(resolution) +
                                " is not a power of two from 16 to 4096");
  }
  for (Face& face : faces_) {
    face.nearness.assign(std::size_t{resolution} * resolution, 0.0f);
  }
}

void ShadowBuffer::clear(const glm::dvec3& point, bool names) {
  point_ = point;
  named_ = names;
  for (Face& face : faces_) {
    const auto begin =
        face.nearness.begin() + static_cast<std::ptrdiff_t>(std::size_t{face.first_row} * resolution_);
    const auto end =
        face.nearness.begin() + static_cast<std::ptrdiff_t>(std::size_t{face.end_row} * resolution_);
    if (begin < end) std::fill(begin, end, 0.0f);
    face.first_row = resolution_;
    face.end_row = 0;
    if (names) face.names.resize(face.nearness.size());
  }
}

bool ShadowBuffer::draw(const Convex& shape, std::span<const Plane> planes, std::uint32_t name) {
  thread_local Outline outline;
  thread_local std::vector<glm::dvec3> sides;
  if (!outline.trace(shape, point_)) return false;
  sides.clear();
  for (const Plane& plane : planes) sides.push_back(plane.normal);
  sides.insert(sides.end(), outline.sides.begin(), outline.sides.end());

  bool drawn = false;
  thread_local std::vector<Linear> cuts, depths;
  for (unsigned f = 0; f < 6; ++f) {
    Window window;
    cuts.clear();
    bool empty = false;
    for (const glm::dvec3& side : sides) {
      Linear cut = on_face(f, side);
      cut.w -= margin * std::sqrt(3.0);  // directions on the face are at most that long
      const double reach = std::abs(cut.u) + std::abs(cut.v);
      if (cut.w + reach <= 0) {
        empty = true;
        break;
      }
      if (cut.w - reach >= 0) continue;
      cut.inverse = 1 / cut.u;
      cuts.push_back(cut);
    }
    if (empty) continue;
    for (const Linear& cut : cuts) {
      if (!window.cut(cut)) {
        empty = true;
        break;
      }
    }
    if (empty) continue;
    const auto rows = window.bounds(1);
    const auto first_row = static_cast<std::int32_t>(std::floor((rows[0] + 1) / pixel_));
    const auto end_row =
        std::min<std::int32_t>(resolution_, static_cast<std::int32_t>(std::ceil((rows[1] + 1) / pixel_)));
    depths.clear();
    for (const glm::dvec3& near : outline.nearness) depths.push_back(on_face(f, near));
    Face& face = faces_[f];
    for (std::int32_t row = std::max<std::int32_t>(0, first_row); row < end_row; ++row) {
      const double low = -1 + static_cast<double>(row) * pixel_, high = low + pixel_;
      double left = -1, right = 1;
      for (const Linear& cut : cuts) {
        const double rest = cut.w + cut.v * (cut.v > 0 ? low : high);
        if (cut.u > 0) {
          left = std::max(left, -rest * cut.inverse);
        } else if (cut.u < 0) {
          right = std::min(right, -rest * cut.inverse);
        } else if (rest < 0) {
          right = left;
        }
      }
      if (left >= right) continue;
      const auto first = left > -1 ? static_cast<std::int32_t>(std::ceil((left + 1 + 1e-9) / pixel_)) : 0;
      const auto end = right < 1 ? static_cast<std::int32_t>(std::floor((right + 1 - 1e-9) / pixel_))
                                 : static_cast<std::int32_t>(resolution_);
      if (first >= end) continue;
      const std::size_t place = static_cast<std::size_t>(row) * resolution_;
      float* const nearness = face.nearness.data() + place;
      drawn = true;
      face.first_row = std::min(face.first_row, static_cast<std::uint32_t>(row));
      face.end_row = std::max(face.end_row, static_cast<std::uint32_t>(row + 1));
      // Farthest over the pixel: each lit face at its worst corner, rounded down.
      std::array<float, 4> start, step;
      const std::size_t count = depths.size();
      const auto at_row = [&](const Linear& d, float& from, float& by) {
        const double terms = std::abs(d.u) + std::abs(d.v) + std::abs(d.w);
        from = static_cast<float>(d.w + d.v * (d.v > 0 ? low : high) - d.u + (d.u > 0 ? 0 : d.u * pixel_) -
                                  1e-6 * terms);
        by = static_cast<float>(d.u * pixel_);
      };
      const auto fill = [&](const auto& value) {
        if (named_) {
          std::uint32_t* const names = face.names.data() + place;
          for (std::int32_t i = first; i < end; ++i) {
            const float now = value(static_cast<float>(i));
            if (now > nearness[i]) nearness[i] = now, names[i] = name;
          }
          return;
        }
        for (std::int32_t i = first; i < end; ++i)
          nearness[i] = std::max(nearness[i], value(static_cast<float>(i)));
      };
      if (count <= 3) {
        for (std::size_t k = 0; k < 3; ++k) at_row(depths[std::min(k, count - 1)], start[k], step[k]);
        if (count == 1) {
          fill([a = start[0], da = step[0]](float i) { return a + da * i; });
        } else {
          fill([a = start, d = step](float i) {
            return std::min(std::min(a[0] + d[0] * i, a[1] + d[1] * i), a[2] + d[2] * i);
          });
        }
      } else {
        thread_local std::vector<std::array<float, 2>> lines;
        lines.resize(count);
        for (std::size_t k = 0; k < count; ++k) at_row(depths[k], lines[k][0], lines[k][1]);
        fill([](float i) {
          float least_of = std::numeric_limits<float>::infinity();
          for (const auto& line : lines) least_of = std::min(least_of, line[0] + line[1] * i);
          return least_of;
        });
      }
    }
  }
  return drawn;
}

/// Calls visit(face, row, first, end, nearness) for runs of pixels that the box touches; nearness(i) is that of the box's nearest point in
/// pixel i of the row, or more. Until it returns true.
template <typename Visit>
bool ShadowBuffer::touched_pixels(const Box& box, const Visit& visit) const {
  // Faces: -x, +x, -y, +y, -z, +z. Corner bits: 1 = high x, 2 = high y, 4 = high z.
  static constexpr std::uint8_t edges[12][4] = {{0, 1, 2, 4}, {2, 3, 3, 4}, {4, 5, 2, 5}, {6, 7, 3, 5},
                                                {0, 2, 0, 4}, {1, 3, 1, 4}, {4, 6, 0, 5}, {5, 7, 1, 5},
                                                {0, 4, 0, 2}, {1, 5, 1, 2}, {2, 6, 0, 3}, {3, 7, 1, 3}};
  std::array<glm::dvec3, 8> corners;
  glm::dvec3 low, high;
  for (int axis = 0; axis < 3; ++axis) {
    low[axis] = double{box.low[axis]} - point_[axis];
    high[axis] = double{box.high[axis]} - point_[axis];
  }
  for (unsigned i = 0; i < 8; ++i) {
    corners[i] = {i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z};
  }
  std::array<bool, 6> lit;
  std::array<glm::dvec3, 6> nearness;
  std::array<glm::dvec3, 12> sides;
  unsigned lit_count = 0, side_count = 0;
  for (int axis = 0; axis < 3; ++axis) {
    lit[2 * axis] = low[axis] > 0;
    lit[2 * axis + 1] = high[axis] < 0;
    for (int end = 0; end < 2; ++end) {
      if (!lit[2 * axis + end]) continue;
      glm::dvec3& near = nearness[lit_count++];
      near = {};
      near[axis] = 1 / (end ? high : low)[axis];
    }
  }
  if (lit_count == 0)
    return visit(0, 0, 0, 1, [](std::uint32_t) { return std::numeric_limits<float>::infinity(); });
  const glm::dvec3 middle = low + high;
  for (const auto& edge : edges) {
    if (lit[edge[2]] == lit[edge[3]]) continue;
    glm::dvec3 side = glm::cross(corners[edge[0]], corners[edge[1]]);
    const double length = glm::length(side);
    if (!(length > 0)) continue;
    sides[side_count++] = side / (glm::dot(side, middle) < 0 ? -length : length);
  }
  for (unsigned f = 0; f < 6; ++f) {
    const int axis = static_cast<int>(f / 2);
    const double nearest =
        f % 2 ? low[axis] : -high[axis];  // least depth; not above 0: may reach up to the point's plane
    if ((f % 2 ? high[axis] : -low[axis]) <= 0) continue;
    Window window;
    std::array<Linear, 12> cuts;
    unsigned cut_count = 0;
    bool empty = false;
    for (unsigned i = 0; i < side_count && !empty; ++i) {
      Linear cut = on_face(f, sides[i]);
      cut.w += margin * std::sqrt(3.0);
      const double reach = std::abs(cut.u) + std::abs(cut.v);
      empty = cut.w + reach < 0;
      cut.inverse = 1 / cut.u;
      if (cut.w - reach < 0) cuts[cut_count++] = cut;
    }
    for (unsigned i = 0; i < cut_count && !empty; ++i) empty = !window.cut(cuts[i]);
    if (empty) continue;
    const auto columns = window.bounds(0), rows = window.bounds(1);
    const auto pixel_of = [&](double x) {
      return static_cast<std::int32_t>(
          std::clamp(std::floor((x + 1) / pixel_), 0.0, static_cast<double>(resolution_ - 1)));
    };
    const std::int32_t leftmost = pixel_of(columns[0] - 1e-9), rightmost = pixel_of(columns[1] + 1e-9) + 1;
    const float bound =
        nearest > 0 ? static_cast<float>(1 / nearest * (1 + 1e-6)) : std::numeric_limits<float>::infinity();
    for (std::int32_t row = pixel_of(rows[0] - 1e-9), end_row = pixel_of(rows[1] + 1e-9) + 1; row < end_row;
         ++row) {
      const double bottom = -1 + static_cast<double>(row) * pixel_, top = bottom + pixel_;
      double left = -1, right = 1;
      for (unsigned i = 0; i < cut_count; ++i) {
        const Linear& cut = cuts[i];
        const double rest = cut.w + cut.v * (cut.v > 0 ? top : bottom);
        if (cut.u > 0) left = std::max(left, -rest * cut.inverse);
        if (cut.u < 0) right = std::min(right, -rest * cut.inverse);
      }
      if (left > right + 1e-9) continue;
      const auto first = std::max(leftmost, pixel_of(left - 1e-9)),
                 end = std::min(rightmost, pixel_of(right + 1e-9) + 1);
      if (first >= end) continue;
      // Nearest over the pixel: each lit face at its best corner, rounded up, and no nearer than the nearest corner.
      std::array<float, 3> start, step;
      for (unsigned k = 0; k < 3; ++k) {
        const Linear d = on_face(f, nearness[std::min(k, lit_count - 1)]);
        const double terms = std::abs(d.u) + std::abs(d.v) + std::abs(d.w);
        start[k] = static_cast<float>(d.w + d.v * (d.v > 0 ? top : bottom) - d.u +
                                      (d.u > 0 ? d.u * pixel_ : 0) + 1e-6 * terms);
        step[k] = static_cast<float>(d.u * pixel_);
      }
      const auto near = [=](std::uint32_t i) {
        const auto x = static_cast<float>(i);
        return std::min(std::min(bound, start[0] + step[0] * x),
                        std::min(start[1] + step[1] * x, start[2] + step[2] * x));
      };
      if (visit(f, static_cast<std::uint32_t>(row), static_cast<std::uint32_t>(first),
                static_cast<std::uint32_t>(end), near)) {
        return true;
      }
    }
  }
  return false;
}

bool ShadowBuffer::hides(const Box& box) const {
  return !touched_pixels(
      box, [&](unsigned face, std::uint32_t row, std::uint32_t first, std::uint32_t end, const auto& near) {
        const float* const drawn = faces_[face].nearness.data() + std::size_t{row} * resolution_;
        unsigned bare = 0;
        for (std::uint32_t i = first; i < end; ++i) bare |= !(drawn[i] > near(i));
        return bare != 0;
      });
}

void ShadowBuffer::names_before(const Box& box, std::vector<std::uint32_t>& names) const {
  touched_pixels(
      box, [&](unsigned face, std::uint32_t row, std::uint32_t first, std::uint32_t end, const auto&) {
        const auto place =
            faces_[face].names.begin() + static_cast<std::ptrdiff_t>(std::size_t{row} * resolution_);
        names.insert(names.end(), place + first, place + end);
        return false;
      });
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
}

}  // namespace vismat
