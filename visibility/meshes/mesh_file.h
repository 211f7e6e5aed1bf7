// Reads triangle meshes as other programs write them: OBJ, PLY, OFF and STL.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "visibility/scene.h"

namespace vismat {

enum class MeshFormat { obj, ply, off, stl };
/// The format that the name's ending (in any case, perhaps before .gz) names; nothing for another ending.
std::optional<MeshFormat> mesh_format(const std::filesystem::path& path);

/// Something that a file holds and a scene does not.
struct LeftOut {
  std::uint64_t count;
  std::string what;  // "unused points that are not numbers within 1e9"
};
/// What a file says that a face belongs to.
struct MeshPart {
  std::string group;     // OBJ: of `o` and `g`, such as "house/door"; STL: the solid
  std::string material;  // OBJ: usemtl
  bool operator==(const MeshPart&) const = default;
};
struct MeshFile {
  Scene scene;  // an object for each part that has faces
  std::vector<MeshPart> parts;
  std::vector<std::string> material_files;  // OBJ: of mtllib
  std::array<double, 3> origin{};  // where the scene's (0, 0, 0) lies in the file's coordinates, in metres
  std::vector<LeftOut> left_out;
  void leave_out(std::uint64_t count, std::string what) {
    if (count > 0) left_out.push_back({count, std::move(what)});
  }
};

/// How a file's coordinates become those of a scene.
struct MeshPlacement {
  float scale = 1;    // metres for each unit of the file
  bool y_up = false;  // x, y, z become x, -z, y
  /// What becomes (0, 0, 0), in metres and with z up; by default a model far away is moved by whole kilometres.
  std::optional<std::array<double, 3>> origin = {};
};

/// Reads the file's triangles in its order; see weld and split_into_components. Coordinates are 64-bit numbers until they are
/// placed. Polygons are cut into triangles, concave ones too; a face of one or two corners becomes a
/// triangle without area, for weld to count. OBJ: positions, faces, groups and names of materials, indices from either end,
/// lines continued by a backslash; lines and points are left out. PLY: text and binary of either byte order, any types
/// and further properties, faces and triangle strips. OFF: text, with colours and so on, with and without line ends
/// between numbers. STL: text and binary. Text may be UTF-8 or UTF-16, with any line ends, and each file packed by gzip.
/// Points whose coordinates are not numbers or beyond 1e9 are left out if no face uses them. Throws FormatError, one line
/// that says where (line, face or byte), for a file that is damaged, cut short or without triangles, for such points in
/// a face, and for indices and counts that are impossible. Memory is bounded by the bytes given, or by 100 times those and
/// 16 MiB if they are packed. O(bytes), and O(corners^2) for a polygon of at most 4096 corners.
MeshFile parse_mesh(std::span<const std::byte> bytes, MeshFormat format, const MeshPlacement& placement = {});
/// The same from a file; each message begins with its path. Throws std::invalid_argument for an ending other than .obj,
/// .ply, .off or .stl, or one of them and .gz.
MeshFile read_mesh(const std::filesystem::path& path, const MeshPlacement& placement = {});

}  // namespace vismat
