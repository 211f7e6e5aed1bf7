// Reads PLY files.
#pragma once
#include <cstddef>
#include <span>

#include "visibility/scene.h"

namespace vismat {

/// Like parse_mesh, for PLY files.
Scene parse_ply(std::span<const std::byte> bytes);

}  // namespace vismat
