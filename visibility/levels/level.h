// A level of a game and what its file says about visibility, whatever kind of file that was.
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

/// Boxes and the scene are in metres, each of which is 32 of the level's units: the engines' player of 56 units is then
/// 1.75 m tall, and the division is exact.
inline constexpr float metres_per_level_unit = 1.0f / 32;

/// Faces that have a place, but no triangles.
struct FacesWithoutTriangles {
  std::uint32_t billboards = 0;  // pictures that turn to the viewer
  std::uint32_t undrawn = 0;     // players only bump into them
  std::uint32_t empty = 0;       // they list no triangle
  std::uint32_t unknown = 0;     // of kinds that are not read, such as foliage
};

struct Level {
  std::string name;               // "pak1-maps.pk3:maps/oa_koth1.bsp", without folders; set by read_level
  std::string format, cells_are;  // "Quake 3 (IBSP 46)", "cluster"; "Doom", "sector"
  VisibilityMatrix cells;         // cells x cells: which cell sees which
  std::vector<Box> cell_bounds;   // one for each cell; [0, 0] if the level gives it no place
  VisibilityMatrix cell_neighbours;
  ObjectTree cell_tree;  // the level's own BSP tree over the cells; without nodes if there is none
  LevelPlaces places;    // which cell a point lies in (Quake only)
  /// False if the file does not say which cell sees which, which parse_quake3_bsp refuses unless told otherwise; `cells`
  /// is then without entries.
  bool has_visibility = true;
  std::vector<std::string>
      notes;            // what one should know of `cells`, each a line: "MAP01 has no REJECT, so ..."
  float far_plane = 0;  // metres: `cells` may leave out what is farther away; 0: no such limit

  // Faces (Quake only): those that some leaf with a cluster refers to, ascending by id. Column f of face_visibility's
  // matrix, and object f of the scene and of the tree, is face face_ids[f] of the file.
  std::vector<std::uint32_t> face_ids;
  std::vector<Box> face_bounds;
  VisibilityMatrix faces_of_cell;  // cells x faces: which faces lie in which cell
  Scene face_scene;
  ObjectTree face_tree;
  /// The number of faces of doors and platforms, which belong to cluster 0 wherever they are; see docs/levels.md.
  std::uint32_t mover_faces = 0;
  std::uint32_t faces_left_out = 0;  // those to which no leaf with a cluster refers
  FacesWithoutTriangles without_triangles;
};

/// A matrix of cells x faces: a face is visible from a cell that sees any cell in which the face lies. Throws
/// FormatError if it has more than most_visible_pairs ones. O(sum over the pairs of cells of the faces in the seen
/// one).
VisibilityMatrix face_visibility(const Level& level);

/// A level that lists more pairs is refused, since its matrix alone would fill a gigabyte.
inline constexpr std::uint64_t most_visible_pairs = std::uint64_t{1} << 28;
/// Returns bits.to_matrix(), or throws a FormatError that begins with `what`.
VisibilityMatrix checked_matrix(const BitRows& bits, const std::string& what);

enum class LevelMatrix { cells, faces };
/// bounds: the bounding_volume_tree over the columns' boxes. level: the level's own BSP tree.
enum class LevelTree { none, bounds, level };
/// The level's matrix with all that is known about it. Throws std::invalid_argument, saying what can be chosen, if the
/// level has no faces or no tree of its own.
Dataset level_dataset(const Level& level, LevelMatrix matrix, LevelTree tree);

/// The level's counts in one line: cells, density, faces, triangles, nodes.
std::string summary(const Level& level);
/// What the scene and the columns of faces do not hold, such as "2 billboards without triangles"; empty if all is there.
std::vector<std::string> left_out_of_faces(const Level& level);

}  // namespace vismat
