// A reader by the name's ending, then axes and units of meshes, then welding and objects.
#include "visibility/meshes/any_scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "matrix/base/byte_reader.h"
#include "visibility/levels/level_file.h"
#include "visibility/meshes/mesh_file.h"
#include "visibility/meshes/text.h"

namespace vismat {
namespace {

using Objects = AnySceneOptions::Objects;

bool is_level(const std::string& where) {
  const std::string lower = lower_case(where);
  return lower.ends_with(".bsp") || lower.ends_with(".pk3") || lower.ends_with(".wad") ||
         lower.find(".pk3:") != std::string::npos || lower.find(".wad:") != std::string::npos;
}

void place(Scene& scene, const std::string& where, const AnySceneOptions& options) {
  for (glm::vec3& vertex : scene.vertices) {
    if (options.y_up) vertex = {vertex.x, -vertex.z, vertex.y};
    vertex *= options.scale;
    for (int axis = 0; axis < 3; ++axis) {
      if (std::abs(vertex[axis]) > 1e9f) {
        throw FormatError(where + ": a coordinate is farther than 1e9 m from the origin once scaled");
      }
    }
  }
}

/// Whether the file has neither the ending nor the first bytes of a scene file; false if there is no such file.
bool is_of_unknown_kind(const std::string& where) {
  const std::string ending = lower_case(std::filesystem::path(where).extension().string());
  if (ending == ".h5" || ending == ".hdf5") return false;
  std::ifstream file(where, std::ios::binary);
  std::array<char, 4> first{};
  return file && !(file.read(first.data(), first.size()) && std::string_view(first.data(), 4) == "\x89HDF");
}

SceneFile scene_of_level(const std::string& where) {
  Level level = read_level(where);
  if (level.face_ids.empty()) throw FormatError(where + ": a " + level.format + " level has no faces to see");
  SceneFile file;
  file.scene = std::move(level.face_scene);
  file.provenance = level.name + ", " + level.format;
  return file;
}

}  // namespace

AnyScene read_any_scene(const std::string& where, const AnySceneOptions& options) {
  if (!(options.scale > 0 && std::isfinite(options.scale))) {
    throw std::invalid_argument("a scene's scale is a number above 0, in metres a unit");
  }
  AnyScene result;
  SceneFile& file = result.file;
  const bool is_mesh = mesh_format(where).has_value();
  if (!is_mesh && (options.scale != 1 || options.y_up)) {
    throw std::invalid_argument(where +
                                ": its lengths and its up are known; a scale and y up are for mesh files");
  }
  if (is_mesh) {
    MeshFile mesh = read_mesh(where);
    file.scene = std::move(mesh.scene);
    result.left_out = std::move(mesh.left_out);
    place(file.scene, where, options);
    file.provenance = std::filesystem::path(where).filename().string();
    char text[48];
    if (options.scale != 1) {
      std::snprintf(text, sizeof text, ", %g m a unit", static_cast<double>(options.scale));
      file.provenance += text;
    }
    if (options.y_up) file.provenance += ", y up";
  } else if (is_level(where)) {
    file = scene_of_level(where);
  } else {
    if (is_of_unknown_kind(where)) {
      throw FormatError(where +
                        ": its ending names no kind of file that is read: .obj, .ply, .off or .stl (also "
                        "before .gz), .bsp, .pk3, .scene.h5");
    }
    file = read_scene(where);
  }
  const Objects objects = options.objects.value_or(is_mesh ? Objects::components : Objects::as_given);
  if (!is_mesh && objects == Objects::as_given && options.weld == 0) return result;

  const std::size_t triangles = file.scene.object_of_triangle.size();
  result.welded = weld(file.scene, options.weld);
  if (triangles > 0 && file.scene.object_of_triangle.empty()) {
    throw FormatError(where + ": none of its " + std::to_string(triangles) + " triangles has an area");
  }
  if (options.weld > 0) {
    char text[48];
    std::snprintf(text, sizeof text, ", welded within %g m", static_cast<double>(options.weld));
    file.provenance += text;
  }
  if (objects == Objects::as_given) return result;
  file.tree.reset();
  if (objects == Objects::components) {
    split_into_components(file.scene);
    file.provenance += ", objects are connected components";
  } else {
    split_into_triangles(file.scene);
    file.provenance += ", objects are triangles";
  }
  return result;
}

}  // namespace vismat
