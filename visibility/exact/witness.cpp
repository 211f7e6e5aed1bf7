// ALGORITHM. A check must not share the weakness of what it checks: no ray caster, no raster, no supporting plane. Boxes,
// widened by more than rounding can be, choose the triangles near a segment; the rest is predicates.h. The ends of segments
// are means of vertices with given weights, so that they lie in the cell and on the object exactly.
#include "visibility/exact/witness.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <numeric>

namespace vismat {
namespace {

bool finite(const glm::vec3& p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

glm::dvec3 rounded(const WeightedMean& mean) {
  glm::dvec3 sum{};
  for (std::size_t i = 0; i < mean.points.size(); ++i) sum += mean.weights[i] * mean.points[i];
  return sum / std::accumulate(mean.weights.begin(), mean.weights.end(), 0.0);
}

// A segment, and a test that no box it meets can fail.
struct Near {
  glm::dvec3 from, to;
  double slack;
  Near(const WeightedMean& a, const WeightedMean& b)
      : from(rounded(a)),
        to(rounded(b)),
        slack(1e-9 * std::max(largest_coordinate(from), largest_coordinate(to))) {}
  template <typename Corner>
  bool to_box(const Corner& low, const Corner& high) const {
    const glm::dvec3 along = to - from, reach = glm::abs(along) * 0.5;
    glm::dvec3 half, offset;
    for (int k = 0; k < 3; ++k) {
      half[k] = (double{high[k]} - double{low[k]}) / 2 + slack;
      offset[k] = (from[k] + to[k]) / 2 - (double{high[k]} + double{low[k]}) / 2;
      if (std::abs(offset[k]) > half[k] + reach[k]) return false;
    }
    const glm::dvec3 turn = glm::abs(glm::cross(along, offset)), arms = glm::abs(along);
    const double more = slack * (arms.x + arms.y + arms.z);
    return turn.x <= half.y * arms.z + half.z * arms.y + more &&
           turn.y <= half.x * arms.z + half.z * arms.x + more &&
           turn.z <= half.x * arms.y + half.y * arms.x + more;
  }
  bool to_triangle(const Triangle& t) const {
    const auto [low, high] = bounds_of(t);
    return to_box(low, high);
  }
};

// The weights of the triangle's point nearest to p [Ericson 2005, 5.1.5]. Any weights name a point of the triangle, so what
// rounding does to them makes it only a little farther.
std::array<double, 3> nearest(const Triangle& t, const glm::dvec3& p) {
  const glm::dvec3 ab = t[1] - t[0], ac = t[2] - t[0], ap = p - t[0];
  const double d1 = glm::dot(ab, ap), d2 = glm::dot(ac, ap);
  if (d1 <= 0 && d2 <= 0) return {1, 0, 0};
  const double d3 = glm::dot(ab, p - t[1]), d4 = glm::dot(ac, p - t[1]);
  if (d3 >= 0 && d4 <= d3) return {0, 1, 0};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return {-d3, d1, 0};
  const double d5 = glm::dot(ab, p - t[2]), d6 = glm::dot(ac, p - t[2]);
  if (d6 >= 0 && d5 <= d6) return {0, 0, 1};
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return {-d6, 0, d2};
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) return {0, d5 - d6, d4 - d3};
  return {va, vb, vc};
}

WeightedMean mean_of(const Triangle& t, const std::array<double, 3>& weights) {
  const double sum = weights[0] + weights[1] + weights[2];
  if (!(sum > 0) || !std::isfinite(sum)) return {{t[0]}, {1}};
  return {{t.begin(), t.end()}, {weights[0] / sum, weights[1] / sum, weights[2] / sum}};
}

WeightedMean random_point(std::span<const glm::dvec3> corners, Random& random) {
  WeightedMean mean{{corners.begin(), corners.end()}, {}};
  for (std::size_t i = 0; i < corners.size(); ++i) mean.weights.push_back(random.fraction() + 1e-3);
  return mean;
}

// A little smaller, for what touches an occluder.
std::vector<glm::dvec3> shrunk(std::span<const glm::dvec3> corners) {
  glm::dvec3 middle{};
  for (const glm::dvec3& corner : corners) middle += corner / static_cast<double>(corners.size());
  std::vector<glm::dvec3> inner;
  for (const glm::dvec3& corner : corners) inner.push_back(corner + 0x1p-30 * (middle - corner));
  return inner;
}

// Within a flat convex polygon, whichever way round its corners run.
bool contains(std::span<const glm::dvec3> polygon, const glm::dvec3& p, double slack) {
  glm::dvec3 normal{};
  for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
    normal += glm::cross(polygon[i] - polygon[0], polygon[i + 1] - polygon[0]);
  }
  if (glm::length(normal) == 0) return false;
  normal = glm::normalize(normal);
  if (std::abs(glm::dot(normal, p - polygon[0])) > slack) return false;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const glm::dvec3 edge = polygon[(i + 1) % polygon.size()] - polygon[i];
    if (glm::dot(glm::cross(normal, edge), p - polygon[i]) < -slack * glm::length(edge)) return false;
  }
  return true;
}

// The eight diagonals, then any.
glm::dvec3 direction(std::uint32_t number, Random& random) {
  glm::dvec3 d;
  for (int k = 0; k < 3; ++k) d[k] = number < 8 ? (number >> k & 1 ? 1 : -1) : 2 * random.fraction() - 1;
  return d;
}

std::string text(const glm::dvec3& p) {
  char buffer[100];
  std::snprintf(buffer, sizeof buffer, "(%.9g, %.9g, %.9g)", p.x, p.y, p.z);
  return buffer;
}

}  // namespace

WitnessCheck::WitnessCheck(const Scene& scene)
    : scene_(scene), bounds_(object_bounds(scene)), triangles_(scene) {}

Triangle WitnessCheck::corners(std::uint32_t triangle) const {
  return corners_of<glm::dvec3>(scene_, triangle);
}

glm::dvec3 WitnessCheck::farthest_vertex(std::uint32_t object, const glm::dvec3& direction) const {
  glm::dvec3 farthest = corners(triangles_.of(object)[0])[0];
  for (const std::uint32_t triangle : triangles_.of(object)) {
    for (const glm::dvec3& vertex : corners(triangle)) {
      if (glm::dot(direction, vertex - farthest) > 0) farthest = vertex;
    }
  }
  return farthest;
}

bool WitnessCheck::crosses_one_of(std::uint32_t object, const WeightedMean& from,
                                  const WeightedMean& to) const {
  const Near near(from, to);
  if (!near.to_box(bounds_[object].low, bounds_[object].high)) return false;
  std::vector<Triangle> close;
  for (const std::uint32_t triangle : triangles_.of(object)) {
    const Triangle t = corners(triangle);
    if (near.to_triangle(t)) close.push_back(t);
  }
  return first_crossed(from, to, close) < close.size();
}

std::optional<std::uint32_t> WitnessCheck::in_between(std::uint32_t object, const WeightedMean& from,
                                                      const WeightedMean& to) const {
  for (std::uint32_t other = 0; other < scene_.object_count; ++other) {
    if (other == object || (!scene_.see_through.empty() && scene_.see_through[other])) continue;
    if (crosses_one_of(other, from, to)) return other;
  }
  return std::nullopt;
}

Doubt WitnessCheck::seen(const Convex& cell, std::uint32_t object, const SightLine& line,
                         std::uint64_t* aimed_again) const {
  if (!finite(line.from) || !finite(line.to)) return "an end of its sight line is not finite";
  const glm::dvec3 from = line.from, to = line.to;
  const double rounding = 0x1p-20 * std::max(largest_coordinate(from), largest_coordinate(to));
  for (const Convex::Face& face : cell.faces) {
    if (const double beyond = glm::dot(face.normal, from) - face.offset; beyond > rounding) {
      return "its sight line begins at " + text(from) + ", " + std::to_string(beyond) +
             " m outside of the cell";
    }
  }
  Triangle target{};
  std::array<double, 3> weights{};
  double distance = INFINITY;
  for (const std::uint32_t triangle : triangles_.of(object)) {
    const Triangle t = corners(triangle);
    const std::array<double, 3> now = nearest(t, to);
    if (const double d = glm::distance(rounded(mean_of(t, now)), to); d < distance) {
      distance = d, target = t, weights = now;
    }
  }
  if (!(distance <= rounding)) {
    return "its sight line ends at " + text(to) + ", " + std::to_string(distance) + " m from the object";
  }
  const std::span<const std::uint32_t> own = triangles_.of(object);
  if (from == to &&
      std::any_of(own.begin(), own.end(), [&](std::uint32_t t) { return meets(corners(t), cell); })) {
    return std::nullopt;
  }

  WeightedMean aim = mean_of(target, weights);
  const WeightedMean start{{from}, {1}};
  const auto first = in_between(object, start, aim);
  if (!first) return std::nullopt;
  if (aim.points.size() == 3) {
    const WeightedMean given = aim;
    for (int power = 20; power >= 8; power -= 3) {
      for (unsigned way = 0; way < 4; ++way) {  // to the middle, to each corner
        const double share = std::ldexp(1, -power);
        for (unsigned i = 0; i < 3; ++i) {
          aim.weights[i] = given.weights[i] * (1 - share) + (way == 0 ? share / 3 : way == i + 1 ? share : 0);
        }
        if (in_between(object, start, aim)) continue;
        if (aimed_again != nullptr) ++*aimed_again;
        return std::nullopt;
      }
    }
  }
  return "its sight line from " + text(from) + " to " + text(to) + " crosses object " +
         std::to_string(*first);
}

Doubt WitnessCheck::hidden(const Convex& cell, std::uint32_t object, const HiddenWitness& witness,
                           std::span<const Occluder> occluders, std::uint32_t samples, Random random) const {
  const std::span<const std::uint32_t> own = triangles_.of(object);
  if (own.empty()) return std::nullopt;
  if (witness.parts.empty()) return "nothing is named that hides it";
  for (const HiddenWitness::Part& part : witness.parts) {
    for (const std::uint32_t o : part.occluders) {
      if (o >= occluders.size())
        return "occluder " + std::to_string(o) + " is named, of only " + std::to_string(occluders.size());
    }
  }
  for (std::uint32_t sample = 0; sample < samples; ++sample) {
    const WeightedMean exact_x =
        sample % 2 == 0
            ? WeightedMean{{farthest_vertex(object, direction(sample / 2, random))}, {1}}
            : random_point(corners(own[random.below(static_cast<std::uint32_t>(own.size()))]), random);
    const glm::dvec3 x = rounded(exact_x);
    const double slack = 1e-9 * (1 + largest_coordinate(x));

    for (const HiddenWitness::Part& part : witness.parts) {
      if (part.patch.beyond && glm::dot(part.patch.beyond->normal, x) < part.patch.beyond->offset) continue;
      const std::vector<glm::dvec3> patch = shrunk(part.patch.corners);
      const auto hiding = std::find_if(part.occluders.begin(), part.occluders.end(), [&](std::uint32_t o) {
        return occluders[o].object != object && hides(occluders[o].shape, patch, std::array{x});
      });
      if (hiding == part.occluders.end()) {
        return "none of " + std::to_string(part.occluders.size()) + " occluders hides its point " + text(x) +
               " from all of the patch at " + text(part.patch.corners[0]);
      }
      std::vector<WeightedMean> starts = {random_point(patch, random)};
      for (const glm::dvec3& corner : patch) starts.push_back({{corner}, {1}});
      for (const WeightedMean& start : starts) {
        if (!crosses_one_of(occluders[*hiding].object, start, exact_x)) {
          return "the sight line from " + text(rounded(start)) + " to " + text(x) + " meets occluder " +
                 std::to_string(*hiding) + ", but no triangle of its object " +
                 std::to_string(occluders[*hiding].object);
        }
      }
    }

    bool outside = false;
    for (const Convex::Face& face : cell.faces) {
      if (glm::dot(face.normal, x) < face.offset) continue;
      outside = true;
      std::vector<glm::dvec3> corners_of_face;
      for (const std::uint16_t corner : face.corners) corners_of_face.push_back(cell.vertices[corner]);
      const glm::dvec3 w = rounded(random_point(corners_of_face, random));
      const bool covered =
          std::any_of(witness.parts.begin(), witness.parts.end(), [&](const HiddenWitness::Part& part) {
            if (!part.patch.beyond) return part.patch.corners == cell.vertices;
            return glm::dot(part.patch.beyond->normal, x) >= part.patch.beyond->offset &&
                   contains(part.patch.corners, w, slack + 1e-9 * largest_coordinate(w));
          });
      if (!covered)
        return "no patch has the point " + text(w) + " of the cell, which has the object in front";
    }
    if (!outside && witness.parts[0].patch.beyond) return "its point " + text(x) + " lies in the cell";
  }
  return std::nullopt;
}

}  // namespace vismat
