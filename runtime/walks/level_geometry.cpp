#include "runtime/walks/level_geometry.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "matrix/base/byte_reader.h"

namespace vismat {
namespace {

constexpr std::uint32_t short_corners = 65536;  // most vertices whose numbers fit 2 bytes

template <typename Number>
void put_number(std::vector<std::byte>& bytes, Number number) {
  const auto raw = std::as_bytes(std::span(&number, 1));
  bytes.insert(bytes.end(), raw.begin(), raw.end());
}

}  // namespace

LevelGeometry geometry_of(const Mesh& mesh, const LevelOfDetail& level) {
  constexpr std::uint32_t unused = 0xffffffff;
  std::vector<std::uint32_t> number(mesh.vertices.size(), unused);
  LevelGeometry geometry;
  geometry.triangles.reserve(level.triangles.size());
  for (const auto& triangle : level.triangles) {
    auto& corners = geometry.triangles.emplace_back();
    for (unsigned i = 0; i < 3; ++i) {
      std::uint32_t& corner = number[triangle[i]];
      if (corner == unused) {
        corner = static_cast<std::uint32_t>(geometry.vertices.size());
        geometry.vertices.emplace_back(mesh.vertices[triangle[i]]);
      }
      corners[i] = corner;
    }
  }
  return geometry;
}

std::vector<std::byte> to_chunk(const LevelGeometry& geometry) {
  std::vector<std::byte> bytes;
  const auto vertices = static_cast<std::uint32_t>(geometry.vertices.size());
  put_number(bytes, vertices);
  put_number(bytes, static_cast<std::uint32_t>(geometry.triangles.size()));
  for (const glm::vec3& vertex : geometry.vertices) {
    for (unsigned axis = 0; axis < 3; ++axis) put_number(bytes, vertex[axis]);
  }
  for (const auto& triangle : geometry.triangles) {
    for (const std::uint32_t corner : triangle) {
      if (vertices <= short_corners) {
        put_number(bytes, static_cast<std::uint16_t>(corner));
      } else {
        put_number(bytes, corner);
      }
    }
  }
  return bytes;
}

LevelGeometry geometry_from_chunk(std::span<const std::byte> chunk) {
  ByteReader reader(chunk, "triangles of an object");
  const auto vertices = reader.number<std::uint32_t>(), triangles = reader.number<std::uint32_t>();
  const bool is_short = vertices <= short_corners;
  const std::uint64_t right = std::uint64_t{12} * vertices + std::uint64_t{is_short ? 6u : 12u} * triangles;
  if (reader.left() != right) {
    reader.fail(std::to_string(vertices) + " vertices and " + std::to_string(triangles) + " triangles take " +
                std::to_string(right) + " bytes, but " + std::to_string(reader.left()) + " follow");
  }
  LevelGeometry geometry;
  geometry.vertices.resize(vertices);
  geometry.triangles.resize(triangles);
  for (glm::vec3& vertex : geometry.vertices) {
    for (unsigned axis = 0; axis < 3; ++axis) {
      vertex[axis] = reader.number<float>();
      if (!std::isfinite(vertex[axis])) reader.fail("a coordinate is no number");
    }
  }
  for (auto& triangle : geometry.triangles) {
    for (std::uint32_t& corner : triangle) {
      corner = is_short ? reader.number<std::uint16_t>() : reader.number<std::uint32_t>();
      if (corner >= vertices) {
        reader.fail("corner " + std::to_string(corner) + " is none of " + std::to_string(vertices) +
                    " vertices");
      }
    }
  }
  return geometry;
}

}  // namespace vismat
