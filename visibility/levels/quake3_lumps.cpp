// A header of 17 (offset, length) pairs, then lumps of fixed-size records that refer to one another by index:
//
//   nodes (3) -> leafs (4) -> leaffaces (5) -> faces (13) -> vertexes (10) and, relative to a face's first,
//   meshverts (11) leaf.cluster -> a row and a column of visdata (16): i32 n, i32 row_bytes, n rows of bits,
//   the lowest bit first
//
//   faces -> shaders (1): what the compiler knew of the material
#include "visibility/levels/quake3_lumps.h"

#include <algorithm>
#include <string_view>

namespace vismat::quake3 {
namespace {

constexpr std::array<const char*, lump_count> lump_names = {
    "entities",    "shaders", "planes",    "nodes",      "leafs",    "leaffaces",
    "leafbrushes", "models",  "brushes",   "brushsides", "vertexes", "meshverts",
    "effects",     "faces",   "lightmaps", "lightvols",  "visdata"};

}  // namespace

std::string name_of(int lump) {
  return "lump " + std::to_string(lump) + " (" + lump_names[lump] + ")";
}

void refuse(int lump, const std::string& what) {
  throw FormatError(name_of(lump) + ": " + what);
}
void refuse(int lump, const char* kind, std::size_t number, const std::string& what) {
  refuse(lump, kind + (" " + std::to_string(number)) + ": " + what);
}

std::string range(std::int64_t first, std::int64_t count) {
  return std::to_string(first) + " to " + std::to_string(first + count - 1);
}
bool in_range(std::int64_t first, std::int64_t count, std::size_t size) {
  return first >= 0 && count >= 0 && first + count <= static_cast<std::int64_t>(size);
}

int version_of(std::span<const std::byte> file) {
  ByteReader header(file, "header");
  const auto magic = header.number<std::array<char, 4>>();
  if (std::string_view(magic.data(), 4) != "IBSP")
    throw FormatError("header: does not begin with IBSP, so it is no Quake level");
  const auto version = header.number<std::int32_t>();
  if (version == 46 || version == 47) return version;
  if (const auto reversed = with_bytes_reversed(version); reversed == 46 || reversed == 47)
    throw FormatError("header: " + big_endian);
  throw FormatError("header: IBSP version " + std::to_string(version) + (version == 38 ? " (Quake 2)" : "") +
                    "; 46 (Quake 3) and 47 (Quake Live, Return to Castle Wolfenstein) are read");
}

Lumps read_directory(std::span<const std::byte> file) {
  constexpr std::array read = {entities_lump,  shaders_lump,  planes_lump,    nodes_lump, leafs_lump,
                               leaffaces_lump, vertexes_lump, meshverts_lump, faces_lump, visdata_lump};
  ByteReader header(file, "header");
  header.bytes(8);  // see version_of
  Lumps lumps;
  for (int i = 0; i < lump_count; ++i) {
    const auto offset = header.number<std::int32_t>(), length = header.number<std::int32_t>();
    if (std::find(read.begin(), read.end(), i) == read.end()) continue;
    if (length == 0) continue;
    if (!in_range(offset, length, file.size())) {
      refuse(i, std::to_string(length) + " bytes at offset " + std::to_string(offset) +
                    " lie outside the file of " + std::to_string(file.size()) + " bytes");
    }
    lumps[i] = file.subspan(static_cast<std::size_t>(offset), static_cast<std::size_t>(length));
  }
  return lumps;
}

}  // namespace vismat::quake3
