// Makes camera paths through the view cells of a scene.
#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "runtime/camera/camera_path.h"
#include "visibility/scene.h"
#include "visibility/view_cells.h"

namespace vismat {

enum class PathKind {
  walk,     // to random cells of the largest connected part, one after another, each time by the shortest way
  turning,  // a walk of a viewer who looks 60 degrees to the left and to the right in turn, every 6 s
  to_and_fro,  // along the first cells of such a walk and back, again and again
  spin,        // turns on the spot, in the middle of a random cell
  roofs,       // to random cells over roofs, through cells that have no triangle above their middle
  teleport,    // a walk with a jump every 5 s, to the farthest of 8 random cells
};
struct PathKindName {
  PathKind kind;
  std::string_view name;
};
/// All kinds, with their names on the command line.
std::span<const PathKindName> path_kinds();

struct PathOptions {
  PathKind kind = PathKind::walk;
  double seconds = 60;  // how long the path is, at most 1e5
  /// Instead of `seconds`: the path ends in the middle of the cell behind so many boundaries. Not for spin and teleport.
  std::optional<std::uint32_t> boundaries = {};
  double speed = 1.5;     // m/s, at most 1000
  double turn = 120;      // degrees a second, the most that a viewer turns, and what a spin turns
  std::uint32_t way = 1;  // boundaries between the ends of to_and_fro
  std::uint64_t seed = 1;
};

/// Makes a path at even speed. The camera stays level and looks to where it will be in a second, no steeper than 45 degrees;
/// over roofs 20 degrees further down. From cell to cell it goes by the passages of passages_of, through the middle of what
/// both share, at the middle of the eyes' heights. So every position is in a view cell, within CellFinder::rounding, and the
/// next is in the same cell or a neighbour, but for jumps: those of teleport, and small ones where ground cells do not fit
/// together (see Passage). Walls within a cell are not looked at, as cells are whole for both sides of them.
///
/// A cell is over a roof if less than its own height lies between it and the highest triangles below, and these reach above the
/// lowest quarter of the scene's height; triangles are looked up by their boxes in squares of the plan.
///
/// There is a pose at each bend, and between them ten a second at least. The same arguments give the same path. Throws
/// std::invalid_argument for options out of range, if there is no view cell, no passage between any two, or none over roofs, or
/// if the path would have more than a million poses.
CameraPath make_camera_path(const Scene& scene, const ViewCells& cells, const PathOptions& options = {});

}  // namespace vismat
