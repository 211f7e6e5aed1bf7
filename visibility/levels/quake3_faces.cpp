#include "visibility/levels/quake3_faces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <utility>

#include "visibility/levels/shader_script.h"

namespace vismat::quake3 {
namespace {

constexpr std::size_t most_scene_entries = 1
                                           << 24;  // vertices or triangles; the largest known level has 54150
constexpr int patch_steps = 4;

// Of a shader: drawn not at all; perhaps not opaque (nonsolid, lightfilter, alphashadow; translucent).
constexpr std::uint32_t surface_nodraw = 0x80, surface_perhaps_clear = 0x4000 | 0x8000 | 0x10000,
                        contents_translucent = 0x20000000;

bool finite(const glm::vec3& p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

// Where step `step` of a side of a patch lies: on which three control points, with which weights.
struct Blend {
  Blend(std::uint32_t step, std::uint32_t steps) {
    const std::uint32_t piece = std::min(step / patch_steps, (steps - 1) / patch_steps - 1);
    const float t = static_cast<float>(step - piece * patch_steps) / patch_steps;
    first = std::size_t{piece} * 2;
    weights = {(1 - t) * (1 - t), 2 * t * (1 - t), t * t};
  }
  std::size_t first;
  std::array<float, 3> weights;
};

}  // namespace

FaceGeometry::FaceGeometry(const Lumps& lumps, const std::set<std::string>& see_through_shaders)
    : shaders_(records_of<Shader>(lumps, shaders_lump)),
      vertices_(records_of<Vertex>(lumps, vertexes_lump)),
      meshverts_(records_of<std::int32_t>(lumps, meshverts_lump)) {
  for (Shader& shader : shaders_) {
    const std::string_view name(shader.name, ::strnlen(shader.name, sizeof shader.name));
    if (see_through_shaders.contains(shader_key(name))) shader.contents |= contents_translucent;
  }
}

Box FaceGeometry::add(const Face& face, std::size_t number) {
  const Shader shader = shader_of(face, number);
  const std::size_t first = scene_.vertices.size(), first_index = scene_.indices.size();
  Box places = empty_box;
  const auto grow_by = [&](std::span<const glm::vec3> corners) {
    for (const glm::vec3& corner : corners) {
      if (finite(corner)) grow(places, corner);
    }
  };
  if (face.type == polygon || face.type == mesh) {
    const auto corners = corners_of(face, number);
    grow_by(corners);
    add_triangles(face, number, corners);
    without_triangles_.empty += face.indices == 0;
  } else if (face.type == patch) {
    add_patch(face, number, corners_of(face, number));
  } else if (face.type == billboard) {
    ++without_triangles_.billboards;
    if (!finite(face.origin)) refuse(faces_lump, "face", number, "its origin is not finite");
    grow(places, face.origin * metres_per_level_unit);
  } else {
    ++without_triangles_.unknown;
    if (in_range(face.first_vertex, face.vertices, vertices_.size())) grow_by(corners_of(face, number));
  }
  if (std::max(scene_.vertices.size(), scene_.indices.size() / 3) > most_scene_entries) {
    refuse(faces_lump, "face", number,
           "the faces up to here make more than " + std::to_string(most_scene_entries) +
               " vertices or triangles");
  }
  for (std::size_t i = first; i < scene_.vertices.size(); ++i) grow(places, scene_.vertices[i]);
  if ((shader.surface & surface_nodraw) != 0) {  // only bumped into
    scene_.vertices.resize(first);
    without_triangles_.undrawn += scene_.indices.size() > first_index;
    scene_.indices.resize(first_index);
  }
  scene_.see_through.push_back((shader.surface & surface_perhaps_clear) != 0 ||
                               (shader.contents & contents_translucent) != 0);
  scene_.object_of_triangle.resize(scene_.indices.size() / 3, scene_.object_count++);
  return zero_if_empty(places);
}

Scene FaceGeometry::take() {
  const auto& clear = scene_.see_through;
  if (std::find(clear.begin(), clear.end(), 1) == clear.end()) scene_.see_through.clear();
  return std::move(scene_);
}

Shader FaceGeometry::shader_of(const Face& face, std::size_t number) const {
  if (shaders_.empty()) return {};
  if (!in_range(face.shader, 1, shaders_.size())) {
    refuse(faces_lump, "face", number,
           "shader " + std::to_string(face.shader) + " of only " + std::to_string(shaders_.size()));
  }
  return shaders_[face.shader];
}

void FaceGeometry::refuse_not_finite(std::size_t vertex) const {
  refuse(vertexes_lump, "vertex", vertex, "its position is not finite");
}

std::vector<glm::vec3> FaceGeometry::corners_of(const Face& face, std::size_t number) const {
  if (!in_range(face.first_vertex, face.vertices, vertices_.size())) {
    refuse(faces_lump, "face", number,
           "vertexes " + range(face.first_vertex, face.vertices) + " of only " +
               std::to_string(vertices_.size()));
  }
  std::vector<glm::vec3> corners;
  for (std::int32_t i = 0; i < face.vertices; ++i) {
    corners.push_back(vertices_[face.first_vertex + i].position * metres_per_level_unit);
  }
  return corners;
}

void FaceGeometry::add_triangles(const Face& face, std::size_t number, std::span<const glm::vec3> corners) {
  if (!in_range(face.first_index, face.indices, meshverts_.size())) {
    refuse(faces_lump, "face", number,
           "meshverts " + range(face.first_index, face.indices) + " of only " +
               std::to_string(meshverts_.size()));
  }
  if (face.indices % 3 != 0) {
    refuse(faces_lump, "face", number,
           std::to_string(face.indices) + " meshverts are no whole number of triangles");
  }
  constexpr std::uint32_t unused = 0xffffffff;
  std::vector<std::uint32_t> place(corners.size(), unused);  // in the scene
  const std::span used(meshverts_.data() + face.first_index, static_cast<std::size_t>(face.indices));
  for (std::size_t i = 0; i < used.size(); ++i) {
    if (used[i] < 0 || used[i] >= face.vertices) {
      refuse(meshverts_lump, "meshvert", face.first_index + i,
             "vertex " + std::to_string(used[i]) + " of a face that has " + std::to_string(face.vertices));
    }
    place[used[i]] = 0;
  }
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (place[i] == unused) continue;
    if (!finite(corners[i])) refuse_not_finite(face.first_vertex + i);
    place[i] = static_cast<std::uint32_t>(scene_.vertices.size());
    scene_.vertices.push_back(corners[i]);
  }
  for (const std::int32_t index : used) scene_.indices.push_back(place[index]);
}

// Biquadratic Bezier pieces of 3 x 3 control points that share their borders.
void FaceGeometry::add_patch(const Face& face, std::size_t number, std::span<const glm::vec3> control) {
  const std::int64_t width = face.width, height = face.height;
  if (width < 3 || height < 3 || width % 2 == 0 || height % 2 == 0 || width * height != face.vertices) {
    refuse(faces_lump, "face", number,
           "a patch of " + std::to_string(width) + " x " + std::to_string(height) + " control points with " +
               std::to_string(face.vertices) +
               " vertexes; both sides are odd, at least 3, and multiply to them");
  }
  for (std::size_t i = 0; i < control.size(); ++i) {
    if (!finite(control[i])) refuse_not_finite(face.first_vertex + i);
  }
  const auto base = static_cast<std::uint32_t>(scene_.vertices.size());
  const auto columns = static_cast<std::uint32_t>((width - 1) / 2 * patch_steps + 1);
  const auto rows = static_cast<std::uint32_t>((height - 1) / 2 * patch_steps + 1);
  for (std::uint32_t row = 0; row < rows; ++row) {
    const Blend down(row, rows);
    for (std::uint32_t column = 0; column < columns; ++column) {
      const Blend along(column, columns);
      glm::vec3 point(0);
      for (std::size_t j = 0; j < 3; ++j) {
        for (std::size_t i = 0; i < 3; ++i) {
          const std::size_t at = (down.first + j) * static_cast<std::size_t>(width) + along.first + i;
          point += control[at] * (along.weights[i] * down.weights[j]);
        }
      }
      scene_.vertices.push_back(point);
    }
  }
  for (std::uint32_t row = 0; row + 1 < rows; ++row) {
    for (std::uint32_t column = 0; column + 1 < columns; ++column) {
      const std::uint32_t a = base + row * columns + column, b = a + columns;
      scene_.indices.insert(scene_.indices.end(), {a, b, a + 1, a + 1, b, b + 1});
    }
  }
}

}  // namespace vismat::quake3
