// Reads Doom maps from a WAD file, whose REJECT lump tells which sectors cannot see one another.
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "visibility/levels/level.h"

namespace vismat {

struct WadMap {
  std::string name;
  std::uint64_t bytes = 0;  // of its lumps together
};
/// The maps of an IWAD or PWAD in the order of its directory. FormatError for a directory outside the file.
std::vector<WadMap> doom_maps(std::span<const std::byte> wad);

/// Sectors are the cells. `map` is compared without case; of several the last counts, as in the engine. In
/// REJECT bit s * sectors + t, the lowest of a byte first, set means that s cannot see t; bits past the
/// lump's end are taken as not set, as ports of the engine do. Neighbours are the sectors on the two sides of
/// a line; boxes span a sector's lines and its floor to ceiling. The tree comes from the classic NODES lump
/// and is empty where that is empty or extended. Throws FormatError, one line naming lump and offender;
/// Hexen's and UDMF maps are refused. Deterministic.
Level parse_doom_map(std::span<const std::byte> wad, std::string_view map);

}  // namespace vismat
