// A level of a game with what it tells about visibility, whatever file it came from.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "matrix/bit_rows.h"
#include "matrix/dataset.h"
#include "matrix/object_tree.h"
#include "matrix/visibility_matrix.h"
#include "visibility/levels/level_places.h"
#include "visibility/scene.h"

namespace vismat {

/// Boxes and the scene are in metres, 32 of the level's units each: the engines' 56-unit player is then 1.75
/// m tall, and the division is exact.
inline constexpr float metres_per_level_unit = 1.0f / 32;

struct Level {
  std::string name;               // "pak1-maps.pk3:maps/oa_koth1.bsp", without folders; set by read_level
  std::string format, cells_are;  // "Quake 3 (IBSP 46)", "cluster"; "Doom", "sector"
  VisibilityMatrix cells;         // cells x cells: which cell sees which
  std::vector<Box> cell_bounds;   // one a cell; [0, 0] where the level gives a cell no place
  VisibilityMatrix cell_neighbours;
  ObjectTree cell_tree;  // the level's own BSP tree over the cells; without nodes where the level has none
  LevelPlaces places;    // which cell a point lies in (Quake only)
  float far_plane = 0;   // metres: `cells` may leave out what is farther away; 0: no such limit

  // Faces (Quake only): those that some leaf with a cluster refers to, ascending by id. Column f of what
  // face_visibility makes, object f of the scene and of the tree is face face_ids[f] of the file.
  std::vector<std::uint32_t> face_ids;
  std::vector<Box> face_bounds;
  VisibilityMatrix faces_of_cell;  // cells x faces: which lie in which, before any visibility
  Scene face_scene;
  ObjectTree face_tree;
  /// Of doors and platforms: filed under cluster 0 wherever they are, see docs/levels.md.
  std::uint32_t mover_faces = 0;
};

/// Cells x faces: a face is visible from a cell that sees any cell the face lies in. Throws FormatError where
/// that makes more than most_visible_pairs. O(sum over the pairs of cells of the faces in the seen one).
VisibilityMatrix face_visibility(const Level& level);

/// A level that lists more is refused, since its matrix alone would fill a gigabyte.
inline constexpr std::uint64_t most_visible_pairs = std::uint64_t{1} << 28;
/// bits.to_matrix(), or a FormatError that begins with `what`.
VisibilityMatrix checked_matrix(const BitRows& bits, const std::string& what);

enum class LevelMatrix { cells, faces };
/// bounds: bounding_volume_tree over the columns' boxes. level: the level's own BSP tree.
enum class LevelTree { none, bounds, level };
/// Throws std::invalid_argument, saying which choice there is, where the level has no faces or no tree of its
/// own.
Dataset level_dataset(const Level& level, LevelMatrix matrix, LevelTree tree);

/// One line of counts: cells, density, faces, triangles, nodes.
std::string summary(const Level& level);

}  // namespace vismat
