// ALGORITHM. Windows, doors, rooms, ledges, stairs, beams and gratings are all unions and differences of boxes. A grid
// through all their sides makes these exact without any geometry: voxels are filled or emptied, and the sides between
// filled and empty voxels are the surface. Vertices are the grid's, so there are no T-junctions; the price is that a
// cut runs through the whole body, and leaves narrow triangles on its far walls.
#include "visibility/generators/solids.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <glm/geometric.hpp>

namespace vismat {
namespace {

void add_triangle(Scene& scene, std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  scene.indices.insert(scene.indices.end(), {a, b, c});
  scene.object_of_triangle.push_back(scene.object_count);
}

}  // namespace

Lattice::Lattice(std::array<std::vector<float>, 3> cuts, float step) {
  for (unsigned axis = 0; axis < 3; ++axis) {
    std::vector<float>& at = cuts[axis];
    std::sort(at.begin(), at.end());
    at.erase(std::unique(at.begin(), at.end()), at.end());
    assert(at.size() >= 2);
    for (std::size_t i = 0; i + 1 < at.size(); ++i) {
      const int parts = std::max(1, static_cast<int>(std::ceil((at[i + 1] - at[i]) / step - 1e-3f)));
      for (int part = 0; part < parts; ++part) {
        planes_[axis].push_back(at[i] +
                                (at[i + 1] - at[i]) * static_cast<float>(part) / static_cast<float>(parts));
      }
    }
    planes_[axis].push_back(at.back());
  }
  filled_.assign(std::size_t(cells(0)) * cells(1) * cells(2), 0);
}

std::size_t Lattice::index(const std::array<int, 3>& cell) const {
  return (std::size_t(cell[2]) * cells(1) + cell[1]) * cells(0) + cell[0];
}

bool Lattice::filled(const std::array<int, 3>& cell) const {
  for (unsigned axis = 0; axis < 3; ++axis) {
    if (cell[axis] < 0 || cell[axis] >= cells(axis)) return false;
  }
  return filled_[index(cell)] != 0;
}

void Lattice::set_cell(const std::array<int, 3>& cell, bool filled) {
  filled_[index(cell)] = filled;
}

void Lattice::set(const Box& box, bool filled) {
  std::array<int, 3> first, last;
  for (unsigned axis = 0; axis < 3; ++axis) {
    const auto inside = [&](int i) {
      const float middle = (planes_[axis][i] + planes_[axis][i + 1]) / 2;
      return middle > box.low[axis] && middle < box.high[axis];
    };
    for (first[axis] = 0; first[axis] < cells(axis) && !inside(first[axis]);) ++first[axis];
    for (last[axis] = first[axis]; last[axis] < cells(axis) && inside(last[axis]);) ++last[axis];
  }
  for (int z = first[2]; z < last[2]; ++z) {
    for (int y = first[1]; y < last[1]; ++y) {
      for (int x = first[0]; x < last[0]; ++x) set_cell({x, y, z}, filled);
    }
  }
}

void Lattice::add_to(Scene& scene) const {
  const std::array<std::size_t, 3> stride = {1, planes_[0].size(), planes_[0].size() * planes_[1].size()};
  std::vector<std::uint32_t> vertex_of_node(stride[2] * planes_[2].size(), 0xffffffff);
  const auto vertex = [&](const std::array<int, 3>& node) {
    std::uint32_t& v = vertex_of_node[node[0] + node[1] * stride[1] + node[2] * stride[2]];
    if (v == 0xffffffff) {
      v = static_cast<std::uint32_t>(scene.vertices.size());
      scene.vertices.emplace_back(planes_[0][node[0]], planes_[1][node[1]], planes_[2][node[2]]);
    }
    return v;
  };
  std::array<int, 3> cell{};
  for (cell[2] = 0; cell[2] < cells(2); ++cell[2]) {
    for (cell[1] = 0; cell[1] < cells(1); ++cell[1]) {
      for (cell[0] = 0; cell[0] < cells(0); ++cell[0]) {
        if (!filled(cell)) continue;
        for (unsigned axis = 0; axis < 3; ++axis) {
          const unsigned u = (axis + 1) % 3, v = (axis + 2) % 3;
          for (const int side : {0, 1}) {
            std::array<int, 3> behind = cell;
            behind[axis] += side ? 1 : -1;
            if (filled(behind)) continue;
            std::array<std::array<int, 3>, 4> nodes;
            nodes.fill(cell);
            for (auto& node : nodes) node[axis] += side;
            ++nodes[1][u], ++nodes[2][u], ++nodes[2][v], ++nodes[3][v];
            if (side == 0) std::swap(nodes[1], nodes[3]);
            const std::uint32_t a = vertex(nodes[0]), b = vertex(nodes[1]), c = vertex(nodes[2]),
                                d = vertex(nodes[3]);
            add_triangle(scene, a, b, c);
            add_triangle(scene, a, c, d);
          }
        }
      }
    }
  }
}

void add_box(Scene& scene, const Box& box, float step) {
  Lattice lattice({{{box.low[0], box.high[0]}, {box.low[1], box.high[1]}, {box.low[2], box.high[2]}}}, step);
  lattice.set(box, true);
  lattice.add_to(scene);
}

void add_loft(Scene& scene, const glm::vec3& first_tip, std::span<const std::vector<glm::vec3>> rings,
              const glm::vec3& last_tip) {
  assert(!rings.empty());
  const auto first = static_cast<std::uint32_t>(scene.vertices.size());
  const auto sides = static_cast<std::uint32_t>(rings[0].size());
  scene.vertices.push_back(first_tip);
  for (const auto& ring : rings) {
    assert(ring.size() == sides);
    scene.vertices.insert(scene.vertices.end(), ring.begin(), ring.end());
  }
  const auto last = static_cast<std::uint32_t>(scene.vertices.size());
  scene.vertices.push_back(last_tip);
  for (std::uint32_t side = 0; side < sides; ++side) {
    const std::uint32_t next = (side + 1) % sides;
    std::uint32_t ring = first + 1;
    add_triangle(scene, first, ring + side, ring + next);
    for (std::size_t i = 1; i < rings.size(); ++i, ring += sides) {
      add_triangle(scene, ring + side, ring + sides + side, ring + sides + next);
      add_triangle(scene, ring + side, ring + sides + next, ring + next);
    }
    add_triangle(scene, ring + next, ring + side, last);
  }
}

void add_turned(Scene& scene, const glm::vec3& base, const glm::vec3& axis, float first_tip,
                std::span<const Turn> profile, float last_tip, unsigned sides) {
  std::vector<std::vector<glm::vec3>> rings;
  for (const Turn& turn : profile)
    rings.push_back(circle(base + turn.along * axis, axis, turn.radius, sides));
  add_loft(scene, base + first_tip * axis, rings, base + last_tip * axis);
}

std::vector<glm::vec3> circle(const glm::vec3& middle, const glm::vec3& axis, float radius, unsigned sides) {
  const glm::dvec3 along(axis);
  const glm::dvec3 aside = std::abs(along.z) < 0.5 ? glm::dvec3(0, 0, 1) : glm::dvec3(1, 0, 0);
  return circle(middle, axis, glm::normalize(glm::cross(aside, along)), radius, sides);
}

std::vector<glm::vec3> circle(const glm::vec3& middle, const glm::vec3& axis, const glm::vec3& start,
                              float radius, unsigned sides) {
  const glm::dvec3 u(start), v = glm::cross(u, glm::dvec3(axis));
  std::vector<glm::vec3> points;
  for (unsigned i = 0; i < sides; ++i) {
    const double angle = 6.283185307179586 * i / sides;
    points.emplace_back(glm::dvec3(middle) + double{radius} * (std::cos(angle) * u + std::sin(angle) * v));
  }
  return points;
}

void add_ground(Scene& scene, float side, float step) {
  const auto squares = std::max(1u, static_cast<std::uint32_t>(std::ceil(side / step)));
  const auto at = [&](std::uint32_t i) { return side * static_cast<float>(i) / static_cast<float>(squares); };
  for (std::uint32_t y = 0; y <= squares; ++y) {
    for (std::uint32_t x = 0; x <= squares; ++x) scene.vertices.emplace_back(at(x), at(y), 0);
  }
  for (std::uint32_t y = 0; y < squares; ++y) {
    for (std::uint32_t x = 0; x < squares; ++x) {
      const std::uint32_t a = y * (squares + 1) + x, b = a + squares + 1;
      scene.indices.insert(scene.indices.end(), {a, a + 1, b + 1, a, b + 1, b});
      scene.object_of_triangle.insert(scene.object_of_triangle.end(), 2, scene.object_count);
    }
  }
}

}  // namespace vismat
