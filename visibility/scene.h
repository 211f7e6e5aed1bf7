// Triangles that belong to objects, and the view cells from which they are looked at.
#pragma once
#include <cstdint>
#include <filesystem>
#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <vector>

#include "matrix/dataset.h"

namespace vismat {

/// Metres, right-handed, z up.
struct Scene {
  std::vector<glm::vec3> vertices;
  std::vector<std::uint32_t> indices;             // 3 per triangle, each < vertices.size()
  std::vector<std::uint32_t> object_of_triangle;  // each < object_count: the matrix's columns
  std::uint32_t object_count = 0;
};

/// One box an object; an object without triangles gets the empty box [0, 0].
std::vector<Box> object_bounds(const Scene& scene);

/// Prisms over triangles of the ground: a viewer stands at a point of the triangle, eyes between the two
/// heights above it.
struct ViewCells {
  std::vector<glm::vec3> corners;  // 3 per cell
  float eye_low = 1.6f, eye_high = 1.6f;
  std::optional<VisibilityMatrix> neighbours;  // cells x cells: which share an edge
  std::uint32_t count() const { return static_cast<std::uint32_t>(corners.size() / 3); }
};

/// One box a cell, from the lowest eye to the highest.
std::vector<Box> cell_bounds(const ViewCells& cells);

/// What a `.scene.h5` file holds.
struct SceneFile {
  Scene scene;
  ViewCells cells;
  std::optional<ObjectTree> tree;  // over the scene's objects
  std::string provenance;
  std::optional<std::uint64_t> seed;
};
SceneFile read_scene(const std::filesystem::path& path);  // FormatError naming file, dataset and offender
void write_scene(const std::filesystem::path& path, const SceneFile& file);

}  // namespace vismat
