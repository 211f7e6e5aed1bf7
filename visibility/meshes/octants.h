// Makes the occupied octants of a scene's octree its objects.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "visibility/scene.h"

namespace vismat {

/// The octants of one level of an octree in which some triangle lies, and what lies in them.
struct Octants {
  /// The same surface, cut where octants meet. An object is what lies in one octant: its opaque triangles or its see-through
  /// ones, so that an octant may have two objects.
  Scene scene;
  std::vector<std::uint32_t> octant_of_object;  // ascending
  std::vector<Box> boxes;                       // cubes in Z-order, one for each octant; metres
  /// The way to each octant from the root, a digit for each level: bits 0, 1 and 2 are set in the upper half along x, y, z.
  std::vector<std::string> paths;
  unsigned levels = 0;  // of division; the root alone has none
  std::uint32_t count() const { return static_cast<std::uint32_t>(boxes.size()); }
};

/// Divides a cube over the scene that shares its low corner, at most `levels` times, as long as no more than `most` octants are
/// occupied. Its side is `scale` times the longest side of the scene's bounds; scales from 1 to 2 give all sizes of octants. A triangle within the plane between two octants lies in the lower one. Triangles without area are left
/// out. Where two triangles share an edge, their pieces share vertices, so that no ray slips through. The same scene and limits
/// give the same octants. Throws std::invalid_argument if no triangle has an area, if
/// `most` is 0, for more than 20 levels, or for a scale below 1.
/// O(levels * pieces).
Octants cut_into_octants(const Scene& scene, std::uint32_t most, unsigned levels = 20, double scale = 1);

}  // namespace vismat
