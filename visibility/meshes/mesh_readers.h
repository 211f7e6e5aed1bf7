// The readers of the formats, for parse_mesh. Each gets the file's bytes, unpacked, and adds to `left_out` what it does not read.
#pragma once
#include <cstddef>
#include <span>

#include "visibility/meshes/mesh_file.h"

namespace vismat {

MeshFile parse_ply(std::span<const std::byte> bytes, const MeshPlacement& placement);
MeshFile parse_off(std::span<const std::byte> bytes, const MeshPlacement& placement);
MeshFile parse_stl(std::span<const std::byte> bytes, const MeshPlacement& placement);

}  // namespace vismat
