// Reads a level from FILE.bsp, FILE.pk3:maps/NAME.bsp or FILE.wad:MAP.
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "visibility/levels/level.h"

namespace vismat {

/// Reads the level. Throws FormatError, or std::runtime_error for files that cannot be read, both beginning with
/// `where`; for a .pk3 or .wad without a map the message names some.
Level read_level(const std::string& where);

struct LevelListing {
  std::string where;        // for read_level
  std::uint64_t bytes = 0;  // of the level, unpacked, as the archive claims
};
/// The levels in a .pk3 or .wad, in the archive's order; for a .bsp the file itself. Kinds of files are told apart by
/// their first bytes. Throws as read_level does.
std::vector<LevelListing> list_levels(const std::filesystem::path& file);

}  // namespace vismat
