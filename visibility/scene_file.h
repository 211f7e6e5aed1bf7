// Reads and writes scene files, which hold triangles, view cells and a tree over the objects, in HDF5.
#pragma once
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
};
/// Throws FormatError naming the file, the array and the bad value.
SceneFile read_scene(const std::filesystem::path& path);
void write_scene(const std::filesystem::path& path, const SceneFile& file);

}  // namespace vismat
