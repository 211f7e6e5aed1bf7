// A reader by the name's ending, then axes and units of meshes, then welding and objects.
#include "visibility/meshes/any_scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <regex>
#include <set>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "matrix/base/atomic_file.h"
#include "matrix/base/byte_reader.h"
#include "visibility/levels/ascii.h"
#include "visibility/levels/level_file.h"
#include "visibility/meshes/materials.h"
#include "visibility/meshes/mesh_file.h"
#include "visibility/meshes/text.h"

namespace vismat {
namespace {

using Objects = AnySceneOptions::Objects;

std::string printed(const char* format, double number) {
  char text[64];
  std::snprintf(text, sizeof text, format, number);
  return text;
}

std::regex expression_of(const std::string& pattern) {
  try {
    return std::regex(pattern, std::regex::ECMAScript | std::regex::icase);
  } catch (const std::regex_error& error) {
    throw std::invalid_argument("--see-through '" + pattern + "': is no regular expression: " + error.what());
  }
}

/// Whether the file has neither the ending nor the first bytes of a scene file; false if there is no such file.
bool is_of_unknown_kind(const std::string& where) {
  const std::string ending = ascii_lower(std::filesystem::path(where).extension().string());
  if (ending == ".h5" || ending == ".hdf5") return false;
  std::ifstream file(where, std::ios::binary);
  std::array<char, 4> first{};
  return file && !(file.read(first.data(), first.size()) && std::string_view(first.data(), 4) == "\x89HDF");
}

AnyScene scene_of_level(const std::string& where) {
  Level level = read_level(where, {.visibility = false});
  if (level.face_ids.empty()) throw FormatError(where + ": a " + level.format + " level has no faces to see");
  AnyScene result;
  result.left_out = left_out_of_faces(level);
  result.file.scene = std::move(level.face_scene);
  result.file.provenance = level.name + ", " + level.format;
  return result;
}

void tell(std::vector<std::string>& notes, const std::string& what, const std::vector<std::string>& names) {
  if (names.empty()) return;
  std::string note = what + ": ";
  for (std::size_t i = 0; i < names.size() && i < 5; ++i) note += (i == 0 ? "" : ", ") + names[i];
  notes.push_back(note + (names.size() > 5 ? " and " + std::to_string(names.size() - 5) + " more" : ""));
}

/// The materials of the mesh, from the files that it names, or else from one of its own name.
Materials materials_of(const MeshFile& mesh, const std::filesystem::path& where, bool& any) {
  Materials materials;
  const std::filesystem::path folder = where.parent_path();
  for (const std::string& name : mesh.material_files) {
    std::string plain = name;
    std::replace(plain.begin(), plain.end(), '\\', '/');
    std::error_code ignored;
    std::filesystem::path path = folder / plain;
    if (!std::filesystem::is_regular_file(path, ignored))
      path = folder / std::filesystem::path(plain).filename();
    if (!std::filesystem::is_regular_file(path, ignored)) {
      materials.missing.push_back(name);
      continue;
    }
    add_materials(read_file(path), path.parent_path(), materials);
    any = true;
  }
  return materials;
}

/// Which of the mesh's parts can be seen through; says so in the notes.
std::vector<std::uint8_t> see_through_parts(const MeshFile& mesh, const std::string& where,
                                            const std::string& pattern, AnyScene& result) {
  bool materials_read = false;
  Materials materials = materials_of(mesh, where, materials_read);
  std::vector<std::string> clear, undefined;
  std::vector<std::uint8_t> parts(mesh.parts.size(), 0);
  const std::regex expression = expression_of(pattern);
  std::set<std::string> told;
  bool every_part_known = true;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const auto& [group, material] = mesh.parts[i];
    const auto defined = materials.see_through.find(material);
    const bool known = defined != materials.see_through.end();
    every_part_known = every_part_known && known;
    std::string why = known ? defined->second : "";
    if (!pattern.empty() && (std::regex_search(group, expression) || std::regex_search(material, expression)))
      why = "--see-through";
    parts[i] = !why.empty();
    const std::string& name = material.empty() ? group : material;
    if (!why.empty() && told.insert(name).second) clear.push_back(name + " (" + why + ")");
    if (!known && !material.empty() && told.insert(material).second) undefined.push_back(material);
  }
  result.file.opacity_unknown = !every_part_known && pattern.empty();
  tell(result.notes, "see-through", clear);
  tell(result.notes, "not there, so that what they are for counts as opaque", materials.missing);
  if (materials_read)
    tell(result.notes, "materials that no file defines, so that they count as opaque", undefined);
  if (result.file.opacity_unknown) {
    result.notes.push_back(
        std::ranges::all_of(mesh.parts, [](const MeshPart& part) { return part.material.empty(); })
            ? "the file does not say what is see-through: every surface counts as opaque"
            : "not every surface has a material that is defined: the others count as opaque");
  }
  return parts;
}

/// Gives the scene one object for each key of a triangle, numbered by their first triangle. Opaque and see-through triangles
/// are never one object.
template <typename Key>
void group_triangles(Scene& scene, const std::function<Key(std::size_t)>& key,
                     const std::function<std::string(const Key&)>& name) {
  std::map<std::pair<Key, bool>, std::uint32_t> number;
  std::vector<std::uint8_t> see_through;
  std::vector<std::string> names;
  bool any = false;
  for (std::size_t t = 0; t < scene.object_of_triangle.size(); ++t) {
    const bool clear = !scene.see_through.empty() && scene.see_through[scene.object_of_triangle[t]] != 0;
    const auto [found, is_new] =
        number.try_emplace({key(t), clear}, static_cast<std::uint32_t>(names.size()));
    if (is_new) {
      see_through.push_back(clear), any = any || clear;
      names.push_back(name(found->first.first));
    }
    scene.object_of_triangle[t] = found->second;
  }
  for (const auto& [keys, object] : number) {  // both of one name
    if (keys.second && number.contains({keys.first, false})) names[object] += " (see-through)";
  }
  scene.object_count = static_cast<std::uint32_t>(names.size());
  scene.see_through = any ? std::move(see_through) : std::vector<std::uint8_t>();
  scene.object_names = std::move(names);
}

/// Tiles are numbered from the scene's (0, 0), in the file's coordinates.
void split_into_tiles(Scene& scene, double side, const std::array<double, 3>& origin) {
  using Tile = std::pair<long, long>;
  group_triangles<Tile>(
      scene,
      [&](std::size_t t) {
        const auto c = corners_of<glm::dvec3>(scene, t);
        const glm::dvec3 middle = (c[0] + c[1] + c[2]) / 3.0;
        return Tile(std::lround(std::floor((middle.x + origin[0]) / side)),
                    std::lround(std::floor((middle.y + origin[1]) / side)));
      },
      [](const Tile& tile) {
        return "tile " + std::to_string(tile.first) + "," + std::to_string(tile.second);
      });
}

/// What to choose where components are not what anybody wants.
void judge_components(const Scene& scene, std::vector<std::string>& notes) {
  std::vector<std::uint64_t> sizes(scene.object_count, 0);
  for (const std::uint32_t object : scene.object_of_triangle) ++sizes[object];
  const double triangles = static_cast<double>(scene.object_of_triangle.size());
  const double largest =
      static_cast<double>(sizes.empty() ? 0 : *std::max_element(sizes.begin(), sizes.end()));
  char text[160];
  if (triangles >= 1000 && largest > triangles / 2) {
    std::snprintf(text, sizeof text,
                  "the largest component has %.0f %% of all triangles; --objects tiles:METRES, groups or "
                  "materials divide it",
                  100 * largest / triangles);
    notes.push_back(text);
  }
  if (scene.object_count >= 10000 && scene.object_count > triangles / 16) {
    std::snprintf(
        text, sizeof text,
        "%u components of %.1f triangles on average; --objects tiles:METRES, groups or materials give fewer",
        scene.object_count, triangles / scene.object_count);
    notes.push_back(text);
  }
}

}  // namespace

AnyScene read_any_scene(const std::string& where, const AnySceneOptions& options) {
  const MeshPlacement& placement = options.placement;
  if (!(placement.scale > 0 && std::isfinite(placement.scale))) {
    throw std::invalid_argument("a scene's scale is a number above 0, in metres a unit");
  }
  AnyScene result;
  SceneFile& file = result.file;
  std::vector<MeshPart> parts;
  const bool is_mesh = mesh_format(where).has_value();
  if (!is_mesh && (placement.scale != 1 || placement.y_up || placement.origin)) {
    throw std::invalid_argument(
        where +
        ": its lengths, its up and its origin are known; a scale, y up and an origin are for mesh files");
  }
  if (is_mesh) {
    MeshFile mesh = read_mesh(where, placement);
    const std::vector<std::uint8_t> clear = see_through_parts(mesh, where, options.see_through, result);
    file.scene = std::move(mesh.scene);
    parts = std::move(mesh.parts);
    if (std::count(clear.begin(), clear.end(), 0) != std::ssize(clear)) file.scene.see_through = clear;
    file.origin = mesh.origin;
    for (const LeftOut& kind : mesh.left_out) {
      result.left_out.push_back(std::to_string(kind.count) + " " + kind.what + " left out");
    }
    file.provenance = std::filesystem::path(where).filename().string();
    if (placement.scale != 1) file.provenance += printed(", %g m a unit", placement.scale);
    if (placement.y_up) file.provenance += ", y up";
    if (file.origin != std::array<double, 3>{}) {
      file.provenance += printed(", origin %.10g", file.origin[0]) + printed(",%.10g", file.origin[1]) +
                         printed(",%.10g", file.origin[2]);
    }
    if (file.opacity_unknown) file.provenance += ", taken as opaque";
  } else if (names_level(where)) {
    result = scene_of_level(where);
  } else {
    if (is_of_unknown_kind(where)) {
      throw FormatError(where +
                        ": its ending names no kind of file that is read: .obj, .ply, .off or .stl (also "
                        "before .gz), .bsp, .pk3, .scene.h5");
    }
    file = read_scene(where);
  }
  Scene& scene = file.scene;
  if (!is_mesh && !options.see_through.empty()) {
    if (scene.object_names.empty())
      throw std::invalid_argument(where + ": its objects have no names for --see-through to find");
    const std::regex expression = expression_of(options.see_through);
    scene.see_through.resize(scene.object_count, 0);
    for (std::uint32_t object = 0; object < scene.object_count; ++object) {
      if (std::regex_search(scene.object_names[object], expression)) scene.see_through[object] = 1;
    }
  }
  const Objects objects = options.objects.value_or(is_mesh ? Objects::components : Objects::as_given);
  if (!is_mesh && (objects == Objects::groups || objects == Objects::materials)) {
    throw std::invalid_argument(where +
                                ": groups and materials are those of mesh files; choose another --objects");
  }
  if (!is_mesh && objects == Objects::as_given && options.weld == 0) return result;

  if (is_mesh) {  // before welding, which leaves out triangles that are there twice in one object
    const auto part = [&](std::size_t t) -> const MeshPart& { return parts[scene.object_of_triangle[t]]; };
    const auto as_named = [](const std::string& name) { return name.empty() ? "(none)" : name; };
    const bool groups = objects == Objects::groups;
    if (groups || objects == Objects::materials) {
      const auto named = [&](const MeshPart& p) { return !(groups ? p.group : p.material).empty(); };
      if (std::none_of(parts.begin(), parts.end(), named)) {
        throw std::invalid_argument(where + ": names no " + (groups ? "groups" : "materials") +
                                    "; choose another --objects, such as components or tiles:METRES");
      }
      group_triangles<std::string>(
          scene, [&](std::size_t t) { return groups ? part(t).group : part(t).material; }, as_named);
    } else {
      group_triangles<int>(
          scene, [](std::size_t) { return 0; }, [](int) { return std::string(); });
      scene.object_names.clear();
    }
  }
  const std::size_t triangles = scene.object_of_triangle.size();
  result.welded = weld(scene, options.weld);
  if (triangles > 0 && scene.object_of_triangle.empty()) {
    throw FormatError(where + ": none of its " + std::to_string(triangles) + " triangles has an area");
  }
  if (options.weld > 0) file.provenance += printed(", welded within %g m", options.weld);
  if (objects == Objects::as_given) return result;
  file.tree.reset();
  switch (objects) {
    case Objects::components:
      split_into_components(scene);
      judge_components(scene, result.notes);
      file.provenance += ", objects are connected components";
      break;
    case Objects::tiles:
      if (!(options.tile > 0 && std::isfinite(options.tile))) {
        throw std::invalid_argument("--objects tiles:METRES needs a side above 0");
      }
      split_into_tiles(scene, options.tile, file.origin);
      file.provenance += printed(", objects are tiles of %g m", options.tile);
      break;
    case Objects::triangles:
      split_into_triangles(scene);
      file.provenance += ", objects are triangles";
      break;
    default: {  // some may have lost all of their triangles
      const std::vector<std::string> names = std::move(scene.object_names);
      const std::vector<std::uint32_t> group = scene.object_of_triangle;
      group_triangles<std::uint32_t>(
          scene, [&](std::size_t t) { return group[t]; }, [&](std::uint32_t g) { return names[g]; });
      file.provenance += objects == Objects::groups ? ", objects are groups" : ", objects are materials";
    }
  }
  return result;
}

}  // namespace vismat
