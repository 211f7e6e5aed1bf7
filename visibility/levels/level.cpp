#include "visibility/levels/level.h"

#include <cstdio>
#include <stdexcept>

#include "matrix/base/byte_reader.h"
#include "visibility/geometry/bounding_volume_tree.h"

namespace vismat {

VisibilityMatrix checked_matrix(const BitRows& bits, const std::string& what) {
  if (const std::uint64_t ones = bits.ones(); ones > most_visible_pairs) {
    throw FormatError(what + ": " + std::to_string(ones) + " pairs; at most " +
                      std::to_string(most_visible_pairs) + " are taken");
  }
  return bits.to_matrix();
}

VisibilityMatrix face_visibility(const Level& level) {
  BitRows visible({level.cells.shape().rows, level.faces_of_cell.shape().columns});
  for (std::uint32_t from = 0; from < visible.shape().rows; ++from) {
    for (const std::uint32_t cell : level.cells.row(from)) {
      for (const std::uint32_t face : level.faces_of_cell.row(cell)) visible.set(from, face);
    }
  }
  return checked_matrix(visible, level.cells_are + " x face");
}

Dataset level_dataset(const Level& level, LevelMatrix matrix, LevelTree tree) {
  const bool faces = matrix == LevelMatrix::faces;
  if (faces && level.face_ids.empty()) {
    throw std::invalid_argument(level.name + ": a " + level.format +
                                " level without faces; take the matrix of cells");
  }
  if (!level.has_visibility) {
    throw std::invalid_argument(level.name +
                                ": was compiled without visibility data; 'vismat see' computes it");
  }
  const ObjectTree& own = faces ? level.face_tree : level.cell_tree;
  if (tree == LevelTree::level && own.size() == 0) {
    throw std::invalid_argument(level.name + ": has no tree of its own that can be read; take --tree bounds");
  }
  Dataset dataset;
  dataset.matrix = faces ? face_visibility(level) : level.cells;
  dataset.rows_are = level.cells_are;
  dataset.columns_are = faces ? "face" : level.cells_are;
  dataset.provenance = level.name + ", " + level.format;
  if (faces && level.mover_faces > 0) {
    dataset.provenance += ", " + std::to_string(level.mover_faces) + " faces of movers filed under cluster 0";
  }
  if (level.far_plane > 0) {
    char limit[64];
    std::snprintf(limit, sizeof limit, ", nothing shown beyond %g m", static_cast<double>(level.far_plane));
    dataset.provenance += limit;
  }
  for (const std::string& note : level.notes) dataset.provenance += ", " + note;
  dataset.guarantee =
      (faces && level.mover_faces > 0) || level.far_plane > 0 ? Guarantee::unknown : Guarantee::conservative;
  dataset.row_bounds = level.cell_bounds;
  dataset.column_bounds = faces ? level.face_bounds : level.cell_bounds;
  dataset.row_neighbours = level.cell_neighbours;
  if (tree == LevelTree::level) dataset.source.tree = own;
  if (tree == LevelTree::bounds) dataset.source.tree = bounding_volume_tree(dataset.column_bounds);
  return dataset;
}

std::string summary(const Level& level) {
  char density[16];
  std::snprintf(density, sizeof density, "%.1f", level.cells.density() * 100);
  std::string line =
      level.format + ": " + std::to_string(level.cells.shape().rows) + " " + level.cells_are +
      (level.has_visibility ? "s, each sees " + (density + std::string(" % of them on average"))
                            : "s, without visibility data");
  if (!level.face_ids.empty()) {
    line += "; " + std::to_string(level.face_ids.size()) + " faces of " +
            std::to_string(level.face_scene.indices.size() / 3) + " triangles";
  }
  return line + "; a tree of " + std::to_string(level.cell_tree.size()) + " nodes";
}

std::vector<std::string> left_out_of_faces(const Level& level) {
  std::vector<std::string> lines;
  const auto tell = [&](std::uint32_t count, const char* what) {
    if (count > 0) lines.push_back(std::to_string(count) + " " + what);
  };
  tell(level.without_triangles.billboards, "billboards without triangles");
  tell(level.without_triangles.undrawn, "faces without triangles since they are never drawn");
  tell(level.without_triangles.empty, "faces without triangles since they list none");
  tell(level.without_triangles.unknown, "faces without triangles since their kind is not read");
  tell(level.faces_left_out, "faces in no cluster left out");
  return lines;
}

}  // namespace vismat
