// ALGORITHM. The apex of an occluder is the solution of a linear program in three unknowns with a handful of constraints:
// each three supporting planes meet in a point, and it is the solution if it lies inside of all others and the normal is a
// sum of theirs with signs that the dual demands. For the projection point the unknowns are the weights of the cell's vertices,
// not the coordinates: so flat and sloping cells need no constraints of their own, and what is found is in the cell.
#include "visibility/shadows/projection_point.h"

#include <nlopt.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <limits>
#include <memory>
#include <numbers>
#include <numeric>

#include "visibility/geometry/point_bounds.h"
namespace vismat {
namespace {

using glm::dvec3;

constexpr std::size_t most_planes = 16;

/// The greatest dot(normal, x) between the planes; nothing if there is no bound.
std::optional<double> farthest(const dvec3& normal, std::span<const Plane> planes, double tolerance) {
  const std::size_t count = planes.size();
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t j = i + 1; j < count; ++j) {
      const dvec3 across = glm::cross(planes[i].normal, planes[j].normal);
      for (std::size_t k = j + 1; k < count; ++k) {
        const double volume = glm::dot(across, planes[k].normal);
        if (std::abs(volume) < 1e-9) continue;
        const dvec3 jk = glm::cross(planes[j].normal, planes[k].normal) / volume,
                    ki = glm::cross(planes[k].normal, planes[i].normal) / volume, ij = across / volume;
        if (std::max({glm::dot(normal, jk), glm::dot(normal, ki), glm::dot(normal, ij)}) > 1e-9) continue;
        const dvec3 x = planes[i].offset * jk + planes[j].offset * ki + planes[k].offset * ij;
        if (std::all_of(planes.begin(), planes.end(), [&](const Plane& plane) {
              return glm::dot(plane.normal, x) >= plane.offset - tolerance;
            })) {
          return glm::dot(normal, x);
        }
      }
    }
  }
  return std::nullopt;
}

double solid_angle(const dvec3& a, const dvec3& b, const dvec3& c) {
  const double la = glm::length(a), lb = glm::length(b), lc = glm::length(c);
  return 2 *
         std::abs(std::atan2(glm::dot(a, glm::cross(b, c)),
                             la * lb * lc + glm::dot(a, b) * lc + glm::dot(b, c) * la + glm::dot(c, a) * lb));
}

dvec3 mix(const Convex& cell, const double* weights) {
  dvec3 sum{};
  double total = 0;
  for (std::size_t i = 0; i < cell.vertices.size(); ++i) {
    const double weight = std::max(0.0, weights[i]);
    sum += weight * (cell.vertices[i] - cell.vertices[0]), total += weight;
  }
  return cell.vertices[0] + (total > 0 ? sum / total : sum);
}

struct Problem {
  const Convex& cell;
  std::span<const Shrinkage> occluders;
  double unit;  // the value at the centre, so that the solver sees values near 1
};

double squares(unsigned count, const double* weights, double* gradient, void* data) {
  const Problem& problem = *static_cast<const Problem*>(data);
  dvec3 v = problem.cell.vertices[0];
  for (unsigned i = 0; i < count; ++i)
    v += weights[i] * (problem.cell.vertices[i] - problem.cell.vertices[0]);
  double sum = 0;
  dvec3 slope{};
  for (const Shrinkage& o : problem.occluders) {
    const double off = glm::dot(o.normal, v) - o.apex;
    sum += off * off;
    slope += 2 * off * o.normal;
  }
  for (unsigned i = 0; gradient && i < count; ++i) {
    gradient[i] = glm::dot(slope, problem.cell.vertices[i] - problem.cell.vertices[0]) / problem.unit;
  }
  return sum / problem.unit;
}

double excess(unsigned count, const double* weights, double* gradient, void*) {
  if (gradient) std::fill(gradient, gradient + count, 1.0);
  return std::accumulate(weights, weights + count, -1.0);
}

}  // namespace

std::optional<Shrinkage> shrinkage(const Convex& cell, const Occluder& occluder,
                                   std::span<const Plane> supporting) {
  if (supporting.size() > most_planes) return std::nullopt;
  const dvec3 middle = middle_of(cell.vertices);
  const Convex& shape = occluder.shape;
  const dvec3 heart = middle_of(shape.vertices);
  if (std::any_of(supporting.begin(), supporting.end(),
                  [&](const Plane& plane) { return glm::dot(plane.normal, heart - middle) < 0; })) {
    return std::nullopt;
  }
  Shrinkage result;
  for (const Convex::Face& face : shape.faces) {
    const bool sees_all = std::all_of(cell.vertices.begin(), cell.vertices.end(), [&](const dvec3& vertex) {
      return glm::dot(face.normal, vertex) >= face.offset;
    });
    if (!sees_all) continue;
    dvec3 twice_area{};
    const dvec3& origin = shape.vertices[face.corners[0]];
    for (std::size_t i = 1; i + 1 < face.corners.size(); ++i) {
      const dvec3 &b = shape.vertices[face.corners[i]], &c = shape.vertices[face.corners[i + 1]];
      twice_area += glm::cross(b - origin, c - origin);
      result.weight += solid_angle(origin - middle, b - middle, c - middle);
    }
    result.normal += twice_area;
  }
  if (!(result.weight > 0)) return std::nullopt;
  result.normal = glm::normalize(result.normal);
  result.plane = farthest_beyond(shape.vertices, result.normal, 0);
  const double size = glm::distance(middle, shape.vertices[0]) + glm::length(middle);
  const std::optional<double> apex = farthest(result.normal, supporting, 1e-9 * size);
  if (!apex || *apex <= result.plane) return std::nullopt;
  result.apex = *apex;
  return result;
}

double value_of(const dvec3& point, std::span<const Shrinkage> occluders, ProjectionObjective objective) {
  double sum = 0;
  for (const Shrinkage& o : occluders) {
    const double at = glm::dot(o.normal, point);
    if (objective == ProjectionObjective::apexes) {
      sum += (at - o.apex) * (at - o.apex);
    } else {
      const double scale = std::clamp((at - o.plane) / (o.apex - o.plane), 0.0, 1.0);
      sum += o.weight * scale * scale;
    }
  }
  return sum;
}

dvec3 projection_point(const Convex& cell, std::span<const Shrinkage> occluders,
                       ProjectionObjective objective) {
  std::vector<double> weights(cell.vertices.size(), 1.0 / static_cast<double>(cell.vertices.size()));
  const dvec3 centre = middle_of(cell.vertices);
  if (objective == ProjectionObjective::areas) {
    dvec3 best = centre;
    double most = value_of(centre, occluders, objective);
    for (const dvec3& vertex : cell.vertices) {
      if (const double value = value_of(vertex, occluders, objective); value > most)
        most = value, best = vertex;
    }
    return best;
  }
  Problem problem{cell, occluders, value_of(centre, occluders, objective)};
  if (!(problem.unit > 0)) return centre;
  const std::unique_ptr<nlopt_opt_s, decltype(&nlopt_destroy)> solver(
      nlopt_create(NLOPT_LD_SLSQP, static_cast<unsigned>(weights.size())), &nlopt_destroy);
  if (!solver || nlopt_set_lower_bounds1(solver.get(), 0) < 0 ||
      nlopt_set_upper_bounds1(solver.get(), 1) < 0 ||
      nlopt_set_min_objective(solver.get(), squares, &problem) < 0 ||
      nlopt_add_equality_constraint(solver.get(), excess, nullptr, 1e-9) < 0 ||
      nlopt_set_ftol_rel(solver.get(), 1e-9) < 0 || nlopt_set_maxeval(solver.get(), 200) < 0) {
    return centre;
  }
  double least = 0;
  nlopt_optimize(solver.get(), weights.data(), &least);  // where it gives up, the best so far will do
  const dvec3 found = mix(cell, weights.data());
  return value_of(found, occluders, objective) < problem.unit ? found : centre;
}

}  // namespace vismat
