// Reads Doom maps from a WAD file, whose REJECT lump says which sectors cannot see one another.
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
/// The maps of an IWAD or PWAD, in the order of its directory. A map reaches from its name to that of the next map;
/// foreign lumps between its own are passed over. Throws FormatError for a directory outside the file.
std::vector<WadMap> doom_maps(std::span<const std::byte> wad);

/// Reads a map. Sectors are the cells. `map` is compared without case; of several maps of that name the last one
/// counts, as in the engine, and of several lumps of one name in a map the first. In REJECT, bit s * sectors + t (the
/// lowest bit of a byte first) is set if s cannot see t; bits past the lump's end count as not set, as in ports of the
/// engine, and Level::notes says so. Neighbours are the sectors on the two sides of a line; a box spans a sector's
/// lines, and its floor to its ceiling. The tree comes from the classic NODES lump and is empty if that is empty or
/// extended. Throws FormatError, one line naming the lump and the bad value; lumps that are not read may lie outside
/// the file; Hexen's and UDMF maps are refused. Deterministic.
Level parse_doom_map(std::span<const std::byte> wad, std::string_view map);

}  // namespace vismat
