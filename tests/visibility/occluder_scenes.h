// Small scenes for tests of occluders, and the test that occluders block.
#pragma once
#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <string>

#include "visibility/shadows/occluders.h"

namespace vismat {

using Place = std::function<glm::dvec3(const glm::dvec3&)>;  // from lattice to world

/// The closed surface of the unit cubes [x, x+1] x ... of a lattice that are filled, two triangles a square, as a new object.
void add_cubes(Scene& scene, glm::ivec3 lattice, const std::function<bool(int x, int y, int z)>& filled,
               const Place& place);
/// Squares [u, u+1] x [v, v+1] of a lattice as a new object, open.
void add_squares(Scene& scene, int us, int vs, const std::function<bool(int u, int v)>& filled,
                 const Place& place);
/// A torus about the z axis, closed.
void add_torus(Scene& scene, double radius, double tube, unsigned around, unsigned across,
               const Place& place);

/// Tries `count` random segments through each occluder, many of them close to its edges or along its faces. Tells of the
/// first that begins where blocks_from() allows and meets no triangle of the object, tested one by one.
std::optional<std::string> find_leak(const Scene& scene, std::span<const Occluder> occluders,
                                     std::uint32_t count, std::uint64_t seed);

}  // namespace vismat
