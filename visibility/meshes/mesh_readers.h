// The readers of the formats that have files of their own. Each reads as parse_mesh says, from bytes that are not packed.
#pragma once
#include <cstddef>
#include <span>

#include "visibility/meshes/mesh_file.h"

namespace vismat {

MeshFile parse_ply(std::span<const std::byte> bytes, const MeshPlacement& placement);
MeshFile parse_off(std::span<const std::byte> bytes, const MeshPlacement& placement);
MeshFile parse_stl(std::span<const std::byte> bytes, const MeshPlacement& placement);

}  // namespace vismat
