// Helpers for making occluders: one object's tolerances and frames, and the test that a shape is an occluder.
#pragma once
#include <array>
#include <cstdint>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <numbers>
#include <span>
#include <vector>

#include "visibility/shadows/occluders.h"

namespace vismat {

/// The most faces of a solid. For a rounder solid, boxes inside it are cheaper occluders.
constexpr std::size_t most_faces = 128;

/// The occluders of one object while they are made, and the object's measures.
struct OccluderMaker {
  const OccluderOptions& options;
  double ground, depth;  // the lowest plane, and how far below it solids reach
  std::uint32_t object = 0;
  std::vector<Occluder> made{};
  // Measures of the object's coordinates:
  double size = 0;                                                // the bounding box's longest side
  double magnitude = 0;                                           // the largest absolute value
  double tolerance() const { return 1e-6 * (size + magnitude); }  // how rough a flat face may be
  /// How far our own arithmetic may be off, at most.
  double rounding() const { return 1e-10 * size + 1e-13 * magnitude; }
  /// Keeps an occluder of the object, extended below the ground if it stands upright there and the options say so.
  void keep(Occluder occluder);
};

/// An orthonormal frame, whose axes are the matrix's columns.
struct Frame {
  glm::dvec3 origin{};
  glm::dmat3 axes{1.0};
  glm::dvec3 local(const glm::dvec3& world) const { return (world - origin) * axes; }
  glm::dvec3 world(const glm::dvec3& p) const { return origin + axes * p; }
};

/// The direction, modulo a right angle, that has most of the added weight.
class MainDirection {
 public:
  void add(double x, double y, double weight);
  double angle() const;  // exactly 0 if it is nearly

 private:
  static constexpr std::size_t bins = 90;
  static constexpr double quarter = std::numbers::pi / 2;
  std::array<double, bins> weights_{}, x_{}, y_{};
};

struct HalfSpace {
  glm::dvec3 normal;
  double offset;  // dot(normal, x - centre) <= offset
};

/// The largest factor up to 1 by which a convex shape that holds `centre` can be scaled about it so that no simplex has
/// a point in its interior, as far as the shape's own sides can tell; 0 if there is none.
double fitting_factor(std::span<const HalfSpace> sides, const glm::dvec3& centre,
                      std::span<const glm::dvec3> vertices,
                      std::span<const std::array<std::uint32_t, 3>> simplices);

/// Scales the points about the centre.
void scale_about(std::vector<glm::dvec3>& points, const glm::dvec3& centre, double factor);

}  // namespace vismat
