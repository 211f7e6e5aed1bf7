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
  /// groups: of OBJ (`o` and `g`) and the solids of STL; materials: of OBJ; tiles: squares of the ground, by a triangle's middle.
  enum class Objects { as_given, components, groups, materials, tiles, triangles };
  std::optional<Objects> objects;  // empty: components for a mesh, as given for other files
  float tile = 0;                  // metres, the side of a tile
  float weld = 0;                  // metres, see weld(); 0 joins only equal vertices
  MeshPlacement placement;         // of a mesh file
  /// A regular expression (ECMAScript, in any case): groups, materials and objects whose names it is found in hide nothing.
  std::string see_through;
};

struct AnyScene {
  SceneFile file;                     // with view cells only if a .scene.h5 has them
  WeldCounts welded;                  // all 0 if objects stay as given and `weld` is 0
  std::vector<std::string> left_out;  // of a mesh or a level, such as "2 billboards without triangles"
  std::vector<std::string>
      notes;  // what a user should know: materials, components that are too many or too large
};

/// Reads `where`: a mesh (.obj, .ply, .off, .stl, also packed as .obj.gz), a Quake 3 level (FILE.bsp,
/// FILE.pk3:maps/NAME.bsp, see names_level), or otherwise a `.scene.h5`. The materials of an OBJ file are looked for beside it, and those that
/// can be seen through make objects that hide nothing: opaque and see-through triangles are never one object. Meshes are always
/// welded, other files if that or new objects are asked for. Groups, materials and tiles give objects their names. The tree of
/// a scene file belongs to its objects and is dropped if they change. Throws FormatError or std::runtime_error for a bad file,
/// beginning with `where`, and std::invalid_argument for options out of range, or that are not for this kind of file.
AnyScene read_any_scene(const std::string& where, const AnySceneOptions& options = {});

}  // namespace vismat
