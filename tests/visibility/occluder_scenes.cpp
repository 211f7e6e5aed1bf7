#include "tests/visibility/occluder_scenes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>
#include <sstream>

#include "matrix/base/random.h"
#include "tests/sanitized.h"

namespace vismat {
namespace {

void add_quad(Scene& scene, const std::array<glm::dvec3, 4>& corners) {
  const auto base = static_cast<std::uint32_t>(scene.vertices.size());
  for (const glm::dvec3& corner : corners) scene.vertices.emplace_back(corner);
  scene.indices.insert(scene.indices.end(), {base, base + 1, base + 2, base, base + 2, base + 3});
  scene.object_of_triangle.insert(scene.object_of_triangle.end(), 2, scene.object_count - 1);
}

double volume(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const glm::dvec3& d) {
  return glm::dot(b - a, glm::cross(c - a, d - a));
}

bool meets(const std::array<glm::dvec3, 3>& t, const glm::dvec3& from, const glm::dvec3& to) {
  const double before = volume(t[0], t[1], t[2], from), behind = volume(t[0], t[1], t[2], to);
  if ((before > 0 && behind > 0) || (before < 0 && behind < 0)) return false;
  const double a = volume(from, to, t[0], t[1]), b = volume(from, to, t[1], t[2]),
               c = volume(from, to, t[2], t[0]);
  // Through a side or a corner, rounding may say that it is on neither of the triangles there.
  const double length = glm::distance(from, to) + glm::distance(from, t[0]),
               rounding = 1e-14 * length * length * length;
  return std::min({a, b, c}) >= -rounding || std::max({a, b, c}) <= rounding;
}

glm::dvec3 direction(Random& random) {
  for (;;) {
    const glm::dvec3 d(2 * random.fraction() - 1, 2 * random.fraction() - 1, 2 * random.fraction() - 1);
    const double length = glm::length(d);
    if (length > 0.01 && length <= 1) return d / length;
  }
}

double outside(const Convex& shape, const glm::dvec3& point) {
  double most = -std::numeric_limits<double>::infinity();
  for (const Convex::Face& face : shape.faces)
    most = std::max(most, glm::dot(face.normal, point) - face.offset);
  return most;
}

}  // namespace

void add_cubes(Scene& scene, glm::ivec3 lattice, const std::function<bool(int, int, int)>& filled,
               const Place& place) {
  ++scene.object_count;
  const auto is_filled = [&](glm::ivec3 p) {
    for (int i = 0; i < 3; ++i) {
      if (p[i] < 0 || p[i] >= lattice[i]) return false;
    }
    return filled(p.x, p.y, p.z);
  };
  for (int z = 0; z < lattice.z; ++z) {
    for (int y = 0; y < lattice.y; ++y) {
      for (int x = 0; x < lattice.x; ++x) {
        const glm::ivec3 at(x, y, z);
        if (!is_filled(at)) continue;
        for (int axis = 0; axis < 3; ++axis) {
          for (const int side : {0, 1}) {
            glm::ivec3 out(0), u(0), v(0);
            out[axis] = side ? 1 : -1;
            if (is_filled(at + out)) continue;
            u[(axis + 1) % 3] = 1, v[(axis + 2) % 3] = 1;
            if (!side) std::swap(u, v);
            const glm::ivec3 corner = side ? at + out : at;
            add_quad(scene, {place(glm::dvec3(corner)), place(glm::dvec3(corner + u)),
                             place(glm::dvec3(corner + u + v)), place(glm::dvec3(corner + v))});
          }
        }
      }
    }
  }
}

void add_squares(Scene& scene, int us, int vs, const std::function<bool(int, int)>& filled,
                 const Place& place) {
  ++scene.object_count;
  for (int v = 0; v < vs; ++v) {
    for (int u = 0; u < us; ++u) {
      if (filled(u, v)) {
        add_quad(scene,
                 {place({u, v, 0}), place({u + 1, v, 0}), place({u + 1, v + 1, 0}), place({u, v + 1, 0})});
      }
    }
  }
}

void add_torus(Scene& scene, double radius, double tube, unsigned around, unsigned across,
               const Place& place) {
  ++scene.object_count;
  const auto at = [&](unsigned i, unsigned j) {
    const double a = 2 * std::numbers::pi * (i % around) / around,
                 b = 2 * std::numbers::pi * (j % across) / across;
    const double from_axis = radius + tube * std::cos(b);
    return place({from_axis * std::cos(a), from_axis * std::sin(a), tube * std::sin(b)});
  };
  for (unsigned i = 0; i < around; ++i) {
    for (unsigned j = 0; j < across; ++j)
      add_quad(scene, {at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
  }
}

std::optional<std::string> find_leak(const Scene& scene, std::span<const Occluder> occluders,
                                     std::uint32_t count, std::uint64_t seed) {
  std::vector<std::vector<std::array<glm::dvec3, 3>>> triangles(scene.object_count);
  for (std::size_t t = 0; t < scene.object_of_triangle.size(); ++t) {
    const auto corner = [&](std::size_t i) { return glm::dvec3(scene.vertices[scene.indices[3 * t + i]]); };
    triangles[scene.object_of_triangle[t]].push_back({corner(0), corner(1), corner(2)});
  }
  const double ground = lowest_point(scene);
  for (std::size_t o = 0; o < occluders.size(); ++o) {
    const Convex& shape = occluders[o].shape;
    const Convex::Face& first = shape.faces[0];
    Random random(seed, o);
    double size = 0;
    for (const glm::dvec3& vertex : shape.vertices)
      size = std::max(size, glm::distance(vertex, shape.vertices[0]));
    glm::dvec3 middle{};
    for (const glm::dvec3& vertex : shape.vertices)
      middle += vertex / static_cast<double>(shape.vertices.size());
    const double margin =
        1e-9 * size + 1e-12 * glm::length(shape.vertices[0]);  // what rounding may be off by
    for (std::uint32_t i = 0; i < test::trials(count); ++i) {
      // A point of the shape, often next to an edge or corner.
      const double sharpness = std::pow(10, 2 * random.fraction());
      glm::dvec3 through{};
      double sum = 0;
      for (const glm::dvec3& vertex : shape.vertices) {
        const double weight = std::pow(random.fraction(), sharpness) + 1e-9;
        through += weight * (vertex - shape.vertices[0]), sum += weight;
      }
      through = shape.vertices[0] + through / sum;
      glm::dvec3 along = direction(random);
      if (random.below(2) == 0) {  // nearly in a face
        const glm::dvec3 normal =
            shape.faces[random.below(static_cast<std::uint32_t>(shape.faces.size()))].normal;
        along -= glm::dot(along, normal) * normal * (1 - std::pow(10, -5 * random.fraction()));
        along = glm::normalize(along);
      }
      // Where a flat segment crosses a plane is rounded; that much it stays away from the edges.
      const double steep = occluders[o].flat ? std::abs(glm::dot(along, first.normal)) : 1;
      through += std::min(0.5, margin / size * 1e-3 / std::max(steep, 1e-12)) * (middle - through);
      const double reach = size * std::pow(10, 1 - 5 * random.fraction());
      const glm::dvec3 from = through - reach * along,
                       to = through + size * std::pow(10, 1 - 4 * random.fraction()) * along;
      if (std::min({from.z, to.z, through.z}) < ground) continue;
      if (outside(shape, from) <= margin || outside(shape, to) <= margin) continue;
      if (occluders[o].flat) {
        const double a = glm::dot(first.normal, from) - first.offset,
                     b = glm::dot(first.normal, to) - first.offset;
        if ((a > 0) == (b > 0) || std::min(std::abs(a), std::abs(b)) <= margin) continue;
      }
      Convex eye;
      eye.vertices = {from};
      if (!blocks_from(occluders[o], eye)) continue;
      const auto& own = triangles[occluders[o].object];
      if (std::none_of(own.begin(), own.end(), [&](const auto& t) { return meets(t, from, to); })) {
        std::ostringstream text;
        text.precision(17);
        text << "occluder " << o << " of object " << occluders[o].object
             << " does not block the segment from (" << from.x << ", " << from.y << ", " << from.z << ") to ("
             << to.x << ", " << to.y << ", " << to.z << ")";
        return text.str();
      }
    }
  }
  return std::nullopt;
}

}  // namespace vismat
