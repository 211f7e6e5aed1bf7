// Reads Quake 3 levels: IBSP versions 46, as the game, OpenArena and their compilers write it, and 47, of Quake Live
// and Return to Castle Wolfenstein, which differs in nothing that is read here.
#pragma once
#include <cstddef>
#include <set>
#include <span>
#include <string>

#include "visibility/levels/level.h"

namespace vismat {

enum class VisibilityData { needed, not_needed };

/// Reads a level. Clusters are the cells; everything in Level but its name is filled in. The cells' boxes, neighbours
/// and the tree come from the leaves that the node tree reaches. Two clusters are neighbours if a leaf of each has
/// boxes at most one unit apart that overlap by more than a unit along at least two axes: they share more than an edge,
/// as far as boxes (rounded to whole units) can tell. Curved patches become 4 x 4 quads for each 3 x 3 control points;
/// billboards, and faces that are never drawn, have a place but no triangles. A face is see-through (docs/levels.md) if
/// the flags of its shader may let light pass, or if `see_through_shaders` has the shader_key of its name. Throws
/// FormatError, one line naming the lump and the bad value, for anything that is not a complete level, and for one
/// without visibility data if that is `needed`: otherwise all faces of its leaves are taken, and `cells` has no
/// entries. What it allocates is bounded by the bytes given and by most_visible_pairs. O(pairs listed + leaves^2 at
/// worst). Deterministic.
Level parse_quake3_bsp(std::span<const std::byte> file, const std::set<std::string>& see_through_shaders = {},
                       VisibilityData visibility = VisibilityData::needed);

}  // namespace vismat
