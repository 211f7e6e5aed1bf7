// Reads Quake 3 levels: IBSP version 46, as the game, OpenArena and their compilers write it.
#pragma once
#include <cstddef>
#include <set>
#include <span>
#include <string>

#include "visibility/levels/level.h"

namespace vismat {

/// Clusters are the cells; everything of Level but its name is filled in. The cells' boxes, neighbours and
/// the tree come from the leafs that the node tree reaches. Two clusters are neighbours if a leaf of each has
/// boxes at most one unit apart that overlap by more than a unit along at least two axes: they share more
/// than an edge, as far as boxes (rounded to whole units) can tell. Patches become 4 x 4 quads per 3 x 3
/// control points; billboards, and faces that are never drawn, have a place but no triangles. What may let light pass, by
/// its shader's flags or because the shader is named here, in lower case, is see-through (docs/levels.md). Throws FormatError, one line naming lump and
/// offender, for anything that is not a whole level with visibility data; what it allocates is bounded by the
/// bytes given and by most_visible_pairs. O(pairs listed + leafs^2 at worst).
/// Deterministic.
Level parse_quake3_bsp(std::span<const std::byte> file,
                       const std::set<std::string>& see_through_shaders = {});

}  // namespace vismat
