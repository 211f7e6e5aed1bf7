// ALGORITHM. The corners are put on a grid of 2^41 steps in the plane, where the sign of a turn is exact. An outline that
// touches itself nowhere is cut by ears: a corner that turns left and whose triangle no other corner touches is cut off.
// Corners on a straight line wait until they end a proper triangle, so that no triangle without area stands for a
// neighbour's vertex on the edge; a simple polygon always has such an ear [Meisters 1975]. For any other outline GEOS rounds
// all crossings to the grid and finds the faces between the edges; those that are inside by the even-odd rule are
// triangulated, once a cut to each hole has joined it with the outline. Such a ring touches itself, so its ears are told by the
// edges that enter the triangle instead of the corners. GEOS's own triangulation is not used: before 3.12 it fails, or leaves
// parts out, where a hole touches the outline in a point, and it leaves out corners on straight lines.
#include "visibility/meshes/triangulation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <map>
#include <utility>

#include "visibility/geometry/geos.h"

namespace vismat {
namespace {

constexpr int grid_bits = 41;

template <typename Visit>
void for_each_part(const Geos& geos, const GEOSGeometry& collection, const Visit& visit) {
  for (int i = 0; i < GEOSGetNumGeometries_r(geos.context(), &collection); ++i) {
    visit(*GEOSGetGeometryN_r(geos.context(), &collection, i));
  }
}

glm::dvec2 point_of(const Geos& geos, const GEOSCoordSequence& points, unsigned i) {
  glm::dvec2 at;
  GEOSCoordSeq_getXY_r(geos.context(), &points, i, &at.x, &at.y);
  return at;
}

double doubled_area(std::span<const glm::dvec2> ring) {
  double sum = 0;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const glm::dvec2 &p = ring[i] - ring[0], q = ring[(i + 1) % ring.size()] - ring[0];
    sum += p.x * q.y - p.y * q.x;
  }
  return sum;
}

/// How many corners the outline has before it repeats itself.
std::size_t period(std::span<const std::uint32_t> ring) {
  for (std::size_t p = 3; p <= ring.size() / 2; ++p) {
    if (ring.size() % p == 0 &&
        std::equal(ring.begin() + static_cast<std::ptrdiff_t>(p), ring.end(), ring.begin()))
      return p;
  }
  return ring.size();
}

}  // namespace

void Triangulator::add(std::span<const std::uint32_t> outline, std::vector<glm::vec3>& points,
                       std::vector<std::uint32_t>& triangles) {
  outline = outline.first(period(outline));
  flatten(outline, points);
  ears_.clear();
  if (is_simple(corners_)) {
    cut_ears(corners_, true);
  } else if (corners_.size() > 2) {
    cut_regions(outline, points);
  }
  for (const std::uint32_t corner : ears_) triangles.push_back(point_of_[corner]);
  if (ears_.empty()) triangles.insert(triangles.end(), {outline[0], outline[1], outline[1]});
}

void Triangulator::flatten(std::span<const std::uint32_t> outline, const std::vector<glm::vec3>& points) {
  origin_ = points[outline[0]];
  glm::dvec3 normal(0), largest(0);  // Newell's, and how large the parts are, which cancel out in a bow tie
  double extent = 0;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const glm::dvec3 here = glm::dvec3(points[outline[i]]) - origin_,
                     next = glm::dvec3(points[outline[(i + 1) % outline.size()]]) - origin_;
    const glm::dvec3 part = glm::cross(here, next);
    normal += part, largest += glm::abs(part);
    for (int k = 0; k < 3; ++k) extent = std::max(extent, std::abs(here[k]));
  }
  const auto longest = [](const glm::dvec3& v) {
    int axis = 0;
    for (const int other : {1, 2}) {
      if (std::abs(v[other]) > std::abs(v[axis])) axis = other;
    }
    return axis;
  };
  axis_ = longest(normal);
  if (std::abs(normal[axis_]) < largest[longest(largest)] / 64) axis_ = longest(largest);
  mirrored_ = normal[axis_] < 0;
  const int u = (axis_ + 1) % 3, v = (axis_ + 2) % 3;
  step_ = extent > 0 ? std::ldexp(1.0, std::ilogb(extent) + 1 - grid_bits) : 1;
  flat_.clear(), point_of_.clear(), corners_.clear();
  for (const std::uint32_t point : outline) {
    const glm::dvec3 at = (glm::dvec3(points[point]) - origin_) / step_;
    const glm::dvec2 place(std::round(at[u]), mirrored_ ? -std::round(at[v]) : std::round(at[v]));
    if (!flat_.empty() && flat_.back() == place) continue;
    flat_.push_back(place);
    point_of_.push_back(point);
  }
  while (flat_.size() > 1 && flat_.back() == flat_.front()) flat_.pop_back(), point_of_.pop_back();
  for (std::uint32_t i = 0; i < flat_.size(); ++i) corners_.push_back(i);
}

/// Above 0 if a, b, c turn left, 0 on a line. Its sign is exact: products are rounded in order, and what rounding took
/// from them decides where they are equal.
double Triangulator::turn(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
  const glm::dvec2 p = flat_[b] - flat_[a], q = flat_[c] - flat_[a];
  const double left = p.x * q.y, right = p.y * q.x;
  if (left != right) return left - right;
  return std::fma(p.x, q.y, -left) - std::fma(p.y, q.x, -right);
}

/// Whether p lies on the line from a to b, and is neither of them.
bool Triangulator::strictly_between(std::uint32_t p, std::uint32_t a, std::uint32_t b) const {
  if (turn(a, b, p) != 0 || flat_[p] == flat_[a] || flat_[p] == flat_[b]) return false;
  const glm::dvec2 &at = flat_[p], &from = flat_[a], &to = flat_[b];
  return at.x >= std::min(from.x, to.x) && at.x <= std::max(from.x, to.x) && at.y >= std::min(from.y, to.y) &&
         at.y <= std::max(from.y, to.y);
}

/// Whether the lines from a to b and from c to d have a point in common.
bool Triangulator::touch(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) const {
  const double to_c = turn(a, b, c), to_d = turn(a, b, d), to_a = turn(c, d, a), to_b = turn(c, d, b);
  if (((to_c > 0 && to_d < 0) || (to_c < 0 && to_d > 0)) &&
      ((to_a > 0 && to_b < 0) || (to_a < 0 && to_b > 0)))
    return true;
  const auto on = [&](double side, std::uint32_t p, std::uint32_t from, std::uint32_t to) {
    return side == 0 && (flat_[p] == flat_[from] || flat_[p] == flat_[to] || strictly_between(p, from, to));
  };
  return on(to_c, c, a, b) || on(to_d, d, a, b) || on(to_a, a, c, d) || on(to_b, b, c, d);
}

/// Whether a part of the line from p to q is inside of the triangle, which turns left: no side of the triangle and not the line
/// itself separates them.
bool Triangulator::enters(std::uint32_t p, std::uint32_t q, std::uint32_t a, std::uint32_t b,
                          std::uint32_t c) const {
  for (const auto& [from, to] : {std::pair{a, b}, {b, c}, {c, a}}) {
    if (turn(from, to, p) <= 0 && turn(from, to, q) <= 0) return false;
  }
  const std::array sides = {turn(p, q, a), turn(p, q, b), turn(p, q, c)};
  return std::any_of(sides.begin(), sides.end(), [](double s) { return s > 0; }) &&
         std::any_of(sides.begin(), sides.end(), [](double s) { return s < 0; });
}

bool Triangulator::is_simple(const Ring& ring) const {
  const std::size_t size = ring.size();
  if (size < 3) return false;
  const auto at = [&](std::size_t i) { return ring[i % size]; };
  if (size <= 4) {  // most faces: convex, or not
    bool convex = true;
    for (std::size_t i = 0; i < size && convex; ++i) convex = turn(at(i), at(i + 1), at(i + 2)) > 0;
    if (convex) return true;
  }
  for (std::size_t i = 0; i < size; ++i) {
    if (turn(at(i), at(i + 1), at(i + 2)) == 0 && !strictly_between(at(i + 1), at(i), at(i + 2)))
      return false;
  }
  std::vector<std::size_t> edges(size);  // by their low end, so that those far apart are not compared
  for (std::size_t i = 0; i < size; ++i) edges[i] = i;
  const auto low = [&](std::size_t i) { return std::min(flat_[at(i)].x, flat_[at(i + 1)].x); };
  const auto high = [&](std::size_t i) { return std::max(flat_[at(i)].x, flat_[at(i + 1)].x); };
  std::sort(edges.begin(), edges.end(), [&](std::size_t i, std::size_t k) { return low(i) < low(k); });
  for (std::size_t n = 0; n < size; ++n) {
    for (std::size_t m = n + 1; m < size && low(edges[m]) <= high(edges[n]); ++m) {
      const std::size_t i = edges[n], k = edges[m];
      const bool neighbours = (i + 1) % size == k || (k + 1) % size == i;
      if (!neighbours && touch(at(i), at(i + 1), at(k), at(k + 1))) return false;
    }
  }
  double area = 0;
  for (std::size_t i = 1; i + 1 < size; ++i) area += turn(ring[0], ring[i], ring[i + 1]);
  return area > 0;
}

bool Triangulator::is_ear(std::size_t before, std::size_t at, std::size_t after, bool simple) const {
  const std::uint32_t a = left_[before], b = left_[at], c = left_[after];
  if (!(turn(a, b, c) > 0)) return false;
  if (simple) {
    return std::none_of(left_.begin(), left_.end(), [&](std::uint32_t i) {
      return i != a && i != b && i != c && turn(a, b, i) >= 0 && turn(b, c, i) >= 0 && turn(c, a, i) >= 0;
    });
  }
  for (std::size_t i = 0; i < left_.size(); ++i) {
    const std::uint32_t p = left_[i], q = left_[(i + 1) % left_.size()];
    if (strictly_between(p, a, c)) return false;
    if (i != before && i != at && enters(p, q, a, b, c)) return false;
  }
  return true;
}

void Triangulator::cut_ears(const Ring& ring, bool simple) {
  left_ = ring;
  std::size_t at = 0, failed = 0;
  while (left_.size() > 3 && failed < left_.size()) {
    const std::size_t size = left_.size(), before = (at + size - 1) % size, after = (at + 1) % size;
    if (is_ear(before, at, after, simple)) {
      for (const std::size_t i : {before, at, after}) ears_.push_back(left_[i]);
      left_.erase(left_.begin() + static_cast<std::ptrdiff_t>(at));
      at = at == size - 1 ? 0 : at;
      failed = 0;
    } else {
      at = after;
      ++failed;
    }
  }
  // Without an ear there would be nothing that is surely inside.
  if (left_.size() == 3 && turn(left_[0], left_[1], left_[2]) > 0)
    ears_.insert(ears_.end(), left_.begin(), left_.end());
}

/// Whether the way from a corner of the ring towards d begins inside.
bool Triangulator::within_corner(const Ring& ring, std::size_t at, std::uint32_t d) const {
  const std::uint32_t a = ring[(at + ring.size() - 1) % ring.size()], b = ring[at],
                      c = ring[(at + 1) % ring.size()];
  const double corner = turn(a, b, c), left_of_first = turn(a, b, d), left_of_second = turn(b, c, d);
  if (corner > 0) return left_of_first > 0 && left_of_second > 0;
  const bool turns_back = corner == 0 && glm::dot(flat_[b] - flat_[a], flat_[c] - flat_[b]) < 0;
  if (turns_back) return left_of_first != 0 || glm::dot(flat_[a] - flat_[b], flat_[d] - flat_[b]) < 0;
  return left_of_first > 0 || left_of_second > 0;
}

/// Whether an edge or corner of the ring is in the way from a to b.
bool Triangulator::blocked(const Ring& ring, std::uint32_t a, std::uint32_t b) const {
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const std::uint32_t p = ring[i], q = ring[(i + 1) % ring.size()];
    if (strictly_between(p, a, b)) return true;
    const double to_p = turn(a, b, p), to_q = turn(a, b, q), to_a = turn(p, q, a), to_b = turn(p, q, b);
    if (((to_p > 0 && to_q < 0) || (to_p < 0 && to_q > 0)) &&
        ((to_a > 0 && to_b < 0) || (to_a < 0 && to_b > 0)))
      return true;
  }
  return false;
}

/// Joins the outline with all holes: first with those that touch it in a corner, or else with the leftmost one by a cut there and
/// back. Holes that touch one another hang together as a tree, or they would part the region.
void Triangulator::join_holes(Ring& outline, std::vector<Ring> holes) const {
  const auto left_end = [&](const Ring& hole) {
    std::pair<double, double> least(flat_[hole[0]].x, flat_[hole[0]].y);
    for (const std::uint32_t corner : hole) least = std::min(least, {flat_[corner].x, flat_[corner].y});
    return least;
  };
  std::sort(holes.begin(), holes.end(),
            [&](const Ring& a, const Ring& b) { return left_end(a) < left_end(b); });
  while (!holes.empty()) {
    const auto touching = std::find_if(holes.begin(), holes.end(),
                                       [&](const Ring& hole) { return joined_by_a_corner(outline, hole); });
    if (touching != holes.end()) {
      holes.erase(touching);
    } else {
      join_by_a_cut(outline, holes);
      holes.erase(holes.begin());
    }
  }
}

bool Triangulator::joined_by_a_corner(Ring& outline, const Ring& hole) const {
  for (std::size_t h = 0; h < hole.size(); ++h) {
    for (std::size_t o = 0; o < outline.size(); ++o) {
      if (outline[o] != hole[h] || !within_corner(outline, o, hole[(h + 1) % hole.size()])) continue;
      Ring way;
      for (std::size_t i = 1; i <= hole.size(); ++i) way.push_back(hole[(h + i) % hole.size()]);
      outline.insert(outline.begin() + static_cast<std::ptrdiff_t>(o) + 1, way.begin(), way.end());
      return true;
    }
  }
  return false;
}

/// Cuts to the first of the holes, by the shortest way that no edge or corner is in.
void Triangulator::join_by_a_cut(Ring& outline, const std::vector<Ring>& holes) const {
  const Ring& hole = holes.front();
  struct Way {
    double length;
    std::size_t from, to;  // in the outline and the hole
  };
  std::vector<Way> ways;
  for (std::size_t o = 0; o < outline.size(); ++o) {
    for (std::size_t h = 0; h < hole.size(); ++h) {
      const glm::dvec2 way = flat_[hole[h]] - flat_[outline[o]];
      ways.push_back({glm::dot(way, way), o, h});
    }
  }
  std::stable_sort(ways.begin(), ways.end(), [](const Way& a, const Way& b) { return a.length < b.length; });
  for (const Way& way : ways) {
    const std::uint32_t a = outline[way.from], b = hole[way.to];
    const auto in_the_way = [&](const Ring& ring) { return blocked(ring, a, b); };
    if (!within_corner(outline, way.from, b) || !within_corner(hole, way.to, a) || in_the_way(outline) ||
        std::any_of(holes.begin(), holes.end(), in_the_way)) {
      continue;
    }
    Ring there_and_back;
    for (std::size_t i = 0; i <= hole.size(); ++i) there_and_back.push_back(hole[(way.to + i) % hole.size()]);
    there_and_back.push_back(a);
    outline.insert(outline.begin() + static_cast<std::ptrdiff_t>(way.from) + 1, there_and_back.begin(),
                   there_and_back.end());
    return;
  }
}

/// How often the outline goes round the place, counter-clockwise.
int Triangulator::winding(const glm::dvec2& at) const {
  int turns = 0;
  for (std::size_t i = 0; i < corners_.size(); ++i) {
    const glm::dvec2 p = flat_[corners_[i]] - at, q = flat_[corners_[(i + 1) % corners_.size()]] - at;
    if ((p.y <= 0) == (q.y <= 0)) continue;
    const glm::dvec2 &low = p.y <= 0 ? p : q,
                     &high = p.y <= 0 ? q : p;  // so that a way back cancels a way out
    if (low.x * high.y > low.y * high.x) turns += p.y <= 0 ? 1 : -1;
  }
  return turns;
}

/// The point in space above a crossing, on an edge of the outline.
glm::vec3 Triangulator::lifted(const glm::dvec2& at, std::span<const std::uint32_t> outline,
                               const std::vector<glm::vec3>& points) const {
  const int u = (axis_ + 1) % 3, v = (axis_ + 2) % 3;
  const auto flat = [&](const glm::dvec3& p) {
    return glm::dvec2(p[u] / step_, (mirrored_ ? -p[v] : p[v]) / step_);
  };
  double nearest = std::numeric_limits<double>::infinity();
  glm::dvec3 result(0);
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const glm::dvec3 a = glm::dvec3(points[outline[i]]) - origin_,
                     b = glm::dvec3(points[outline[(i + 1) % outline.size()]]) - origin_;
    const glm::dvec2 along = flat(b) - flat(a);
    const double length = glm::dot(along, along);
    if (!(length > 0)) continue;
    const double t = std::clamp(glm::dot(at - flat(a), along) / length, 0.0, 1.0);
    const glm::dvec3 there = a + t * (b - a);
    const double distance = glm::distance(flat(there), at);
    if (distance < nearest) nearest = distance, result = there;
  }
  return glm::vec3(result + origin_);
}

void Triangulator::cut_regions(std::span<const std::uint32_t> outline, std::vector<glm::vec3>& points) {
  const Geos geos;
  const auto edges = geos.own(geos.ring(flat_));
  const auto noded = geos.own(GEOSUnaryUnionPrec_r(geos.context(), edges.get(), 1));
  const GEOSGeometry* lines = noded.get();
  const auto faces = geos.own(GEOSPolygonize_r(geos.context(), &lines, 1));

  std::map<std::pair<double, double>, std::uint32_t> numbers;
  for (const std::uint32_t corner : corners_) numbers.try_emplace({flat_[corner].x, flat_[corner].y}, corner);
  const auto ring_of = [&](const GEOSGeometry& geometry, bool counter_clockwise) {
    const GEOSCoordSequence* coordinates = GEOSGeom_getCoordSeq_r(geos.context(), &geometry);
    unsigned count = 0;
    GEOSCoordSeq_getSize_r(geos.context(), coordinates, &count);
    std::vector<glm::dvec2> places;
    for (unsigned i = 0; i + 1 < count; ++i) places.push_back(point_of(geos, *coordinates, i));
    if ((doubled_area(places) > 0) != counter_clockwise) std::reverse(places.begin(), places.end());
    Ring ring;
    for (const glm::dvec2& place : places) {
      const auto [found, is_new] =
          numbers.try_emplace({place.x, place.y}, static_cast<std::uint32_t>(flat_.size()));
      if (is_new) {
        flat_.push_back(place);
        point_of_.push_back(static_cast<std::uint32_t>(points.size()));
        points.push_back(lifted(place, outline, points));
      }
      ring.push_back(found->second);
    }
    return ring;
  };
  for_each_part(geos, *faces, [&](const GEOSGeometry& face) {
    const auto inside = geos.own(GEOSPointOnSurface_r(geos.context(), &face));
    const int turns = winding(point_of(geos, *GEOSGeom_getCoordSeq_r(geos.context(), inside.get()), 0));
    if (turns % 2 == 0) return;
    Ring ring = ring_of(*GEOSGetExteriorRing_r(geos.context(), &face), true);
    std::vector<Ring> holes;
    for (int i = 0; i < GEOSGetNumInteriorRings_r(geos.context(), &face); ++i) {
      holes.push_back(ring_of(*GEOSGetInteriorRingN_r(geos.context(), &face, i), false));
    }
    join_holes(ring, std::move(holes));
    const std::size_t before = ears_.size();
    cut_ears(ring, false);
    if (turns < 0) {
      for (std::size_t i = before; i < ears_.size(); i += 3) std::swap(ears_[i + 1], ears_[i + 2]);
    }
  });
}

}  // namespace vismat
