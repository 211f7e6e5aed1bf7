// Reads a scene from any kind of file that holds triangles.
#pragma once
#include <cstdint>
#include <optional>
#include <string>

#include "visibility/meshes/components.h"
#include "visibility/scene_file.h"

namespace vismat {

struct AnySceneOptions {
  enum class Objects { as_given, components, triangles };
  std::optional<Objects> objects;  // nothing: components of a mesh, as given of other files
  float weld = 0;                  // metres, see weld(); 0 joins equal vertices alone
  float scale = 1;                 // metres for each unit of a mesh file
  bool y_up = false;               // a mesh's y axis points up: its x, y, z become x, -z, y
};

struct AnyScene {
  SceneFile file;     // without view cells but those of a .scene.h5
  WeldCounts welded;  // nothing where objects stay as given and no tolerance is
};

/// `where`: a mesh (.obj, .ply, .off, .stl), a Quake-3 level (FILE.bsp, FILE.pk3:maps/NAME.bsp), otherwise a `.scene.h5`. Meshes are
/// always welded, other files where that or new objects are asked for; a scene file's tree goes with its objects, so new ones have
/// none. Throws FormatError or std::runtime_error for a bad file, beginning with `where`, and std::invalid_argument for options out
/// of range, or a scale or y_up for what is no mesh.
AnyScene read_any_scene(const std::string& where, const AnySceneOptions& options = {});

}  // namespace vismat
