#include "visibility/shadows/occluder_maker.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <utility>

namespace vismat {
namespace {

using glm::dvec3;
using Triangle = std::array<std::uint32_t, 3>;

constexpr double least_fit = 0.99;

/// Solids and polygons whose lowest corners lie on the ground, with vertical edges up from them.
bool stands_upright(const Convex& shape, double ground) {
  bool stands = false;
  for (const Convex::Edge& edge : shape.edges) {
    const dvec3 &a = shape.vertices[edge.ends[0]], &b = shape.vertices[edge.ends[1]];
    stands |= a.z == ground;
    if ((a.z == ground) != (b.z == ground) && (a.x != b.x || a.y != b.y)) return false;
  }
  return stands;
}

}  // namespace

void MainDirection::add(double x, double y, double weight) {
  double angle = std::fmod(std::atan2(y, x), quarter);
  if (angle < 0) angle += quarter;
  const auto bin = std::min<std::size_t>(static_cast<std::size_t>(angle / quarter * bins), bins - 1);
  weights_[bin] += weight;
  // Averaged as a unit vector of four times the angle, so that 0 and a right angle are near.
  x_[bin] += weight * std::cos(4 * angle), y_[bin] += weight * std::sin(4 * angle);
}
double MainDirection::angle() const {
  std::size_t best = 0;
  double most = -1;
  for (std::size_t i = 0; i < bins; ++i) {
    const double weight = weights_[i] + weights_[(i + 1) % bins];
    if (weight > most) most = weight, best = i;
  }
  const std::size_t next = (best + 1) % bins;
  const double angle = std::atan2(y_[best] + y_[next], x_[best] + x_[next]) / 4;
  return std::abs(angle) < 1e-6 ? 0 : angle;
}

void OccluderMaker::keep(Occluder occluder) {
  Convex& shape = occluder.shape;
  if (options.extend_below_ground && stands_upright(shape, ground) &&
      (!occluder.flat || std::abs(shape.faces[0].normal.z) < 1e-15)) {
    for (dvec3& vertex : shape.vertices) {
      if (vertex.z == ground) vertex.z -= depth;
    }
    for (Convex::Face& face : shape.faces) face.offset = farthest_beyond(shape.vertices, face.normal, 0);
  }
  occluder.object = object;
  made.push_back(std::move(occluder));
}

double fitting_factor(std::span<const HalfSpace> sides, const dvec3& centre, std::span<const dvec3> vertices,
                      std::span<const Triangle> simplices) {
  double least = 1;
  for (const Triangle& corners : simplices) {
    double most = 0;
    for (const HalfSpace& side : sides) {
      double nearest = std::numeric_limits<double>::infinity();
      for (const std::uint32_t corner : corners) {
        nearest = std::min(nearest, glm::dot(side.normal, vertices[corner] - centre));
      }
      if (nearest < 0) continue;
      most = std::max(most, side.offset > 0 ? nearest / side.offset : 1.0);
      if (most >= least) break;
    }
    least = std::min(least, most);
    if (least < least_fit) return 0;
  }
  return least < 1 - 1e-13 ? least * (1 - 1e-10) : 1;
}

void scale_about(std::vector<dvec3>& points, const dvec3& centre, double factor) {
  for (dvec3& p : points) p = centre + factor * (p - centre);
}

}  // namespace vismat
