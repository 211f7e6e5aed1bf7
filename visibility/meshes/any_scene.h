// Reads a scene from any kind of file that holds triangles.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "visibility/meshes/components.h"
#include "visibility/meshes/mesh_file.h"
#include "visibility/scene_file.h"

namespace vismat {

struct AnySceneOptions {
  enum class Objects { as_given, components, triangles };
  std::optional<Objects> objects;  // empty: components for a mesh, as given for other files
  float weld = 0;                  // metres, see weld(); 0 joins only equal vertices
  float scale = 1;                 // metres for each unit of a mesh file
  bool y_up = false;               // a mesh's y axis points up: its x, y, z become x, -z, y
};

struct AnyScene {
  SceneFile file;                 // with view cells only if a .scene.h5 has them
  WeldCounts welded;              // all 0 if objects stay as given and `weld` is 0
  std::vector<LeftOut> left_out;  // of a mesh file
};

/// Reads `where`: a mesh (.obj, .ply, .off, .stl, also packed as .obj.gz), a Quake 3 level (FILE.bsp, FILE.pk3:maps/NAME.bsp), or otherwise a
/// `.scene.h5`. Meshes are always welded, other files if that or new objects are asked for. The tree of a scene file
/// belongs to its objects and is dropped if they change. Throws FormatError or std::runtime_error for a bad file,
/// beginning with `where`, and std::invalid_argument for options out of range, or for `scale` or `y_up` with a file
/// that is no mesh.
AnyScene read_any_scene(const std::string& where, const AnySceneOptions& options = {});

}  // namespace vismat
