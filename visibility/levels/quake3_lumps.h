// The lumps of a Quake 3 level: a directory of arrays of records, and the errors that name one of them.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <string>
#include <vector>

#include "visibility/levels/level_tree.h"
#include "visibility/levels/records.h"

namespace vismat::quake3 {

enum LumpNumber {
  entities_lump = 0,
  shaders_lump = 1,
  planes_lump = 2,
  nodes_lump = 3,
  leafs_lump = 4,
  leaffaces_lump = 5,
  vertexes_lump = 10,
  meshverts_lump = 11,
  faces_lump = 13,
  visdata_lump = 16,
  lump_count = 17
};

struct Shader {
  char name[64];
  std::uint32_t surface, contents;  // flags
};
struct Node {
  std::int32_t plane;
  BspChildren children;
  std::int32_t low[3], high[3];
};
struct Leaf {
  std::int32_t cluster, area;
  std::array<std::int32_t, 3> low, high;
  std::int32_t first_face, faces, first_brush, brushes;
};
struct Vertex {
  glm::vec3 position;
  float texture[2][2], normal[3];
  std::uint8_t colour[4];
};
enum FaceType { polygon = 1, patch = 2, mesh = 3, billboard = 4 };  // foliage of later games is 5
struct Face {
  std::int32_t shader, effect, type, first_vertex, vertices, first_index, indices, lightmap[5];
  glm::vec3 origin;
  float lightmap_axes[2][3], normal[3];
  std::int32_t width, height;  // of a patch's control points
};
static_assert(sizeof(Shader) == 72 && sizeof(Node) == 36 && sizeof(Leaf) == 48 && sizeof(Vertex) == 44 &&
              sizeof(Face) == 104);

using Lumps = std::array<std::span<const std::byte>, lump_count>;

/// The version of the format. Throws FormatError, as do the functions below, if the file is no level of a version that
/// is read.
int version_of(std::span<const std::byte> file);
/// Finds the lumps. Throws FormatError if one lies outside the file; lumps that are not named above stay empty.
Lumps read_directory(std::span<const std::byte> file);

/// The lump as messages name it: "lump 13 (faces)".
std::string name_of(int lump);
[[noreturn]] void refuse(int lump, const std::string& what);
[[noreturn]] void refuse(int lump, const char* kind, std::size_t number, const std::string& what);

/// A range as messages name it: "3 to 7".
std::string range(std::int64_t first, std::int64_t count);
bool in_range(std::int64_t first, std::int64_t count, std::size_t size);

template <typename Record>
std::vector<Record> records_of(const Lumps& lumps, int lump) {
  return read_records<Record>(lumps[lump], name_of(lump));
}

}  // namespace vismat::quake3
