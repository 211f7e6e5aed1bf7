// Reads and writes scene files, which hold triangles, view cells and a tree over the objects, in HDF5.
#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "matrix/object_tree.h"
#include "visibility/scene.h"
#include "visibility/view_cells.h"

namespace vismat {

/// What a `.scene.h5` file holds.
struct SceneFile {
  Scene scene;
  ViewCells cells;
  std::optional<ObjectTree> tree;  // over the scene's objects
  std::string provenance;
  std::optional<std::uint64_t> seed;
  /// Where the scene's (0, 0, 0) lies in the coordinates of the file that it was made from, metres. Maps have numbers that
  /// are too large for floats.
  std::array<double, 3> origin{};
  /// Whether the scene's file could not say what is see-through, so that every surface is taken to be opaque.
  bool opacity_unknown = false;
};
/// Throws FormatError naming the file, the array and the bad value.
SceneFile read_scene(const std::filesystem::path& path);
void write_scene(const std::filesystem::path& path, const SceneFile& file);
/// A checksum of triangles, objects and view cells, by which files made of a scene know it. O(triangles).
std::uint32_t checksum_of(const SceneFile& file);

}  // namespace vismat
