// Reads a level from FILE.bsp, FILE.pk3:maps/NAME.bsp, FILE.wad:MAP or FILE.zip:NAME.wad:MAP.
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "visibility/levels/level.h"

namespace vismat {

/// What a caller cannot do without.
struct LevelNeeds {
  bool visibility =
      true;  // otherwise a level without visibility data is read, too; see Level::has_visibility
  bool see_through = true;  // otherwise shader scripts that cannot be read are passed over
};
/// Reads the level. Throws FormatError, or std::runtime_error for files that cannot be read, both beginning with
/// `where`; for an archive or .wad without a map the message names some.
Level read_level(const std::string& where, LevelNeeds needs = {});

/// Whether `where` is meant for read_level: by the ending (.bsp, .pk3, .pk4, .zip, .wad) of the file or of the archive
/// before a colon, or because the file begins as such a file does.
bool names_level(const std::string& where);

struct LevelListing {
  std::string where;        // for read_level
  std::uint64_t bytes = 0;  // of the level, unpacked, as the archive claims
};
/// The levels in a zip archive or .wad, in its order; for a .bsp the file itself. A .wad in an archive counts as its
/// maps, or as one level if they cannot be listed. Kinds of files are told apart by their first bytes. Throws as read_level does.
std::vector<LevelListing> list_levels(const std::filesystem::path& file);

}  // namespace vismat
