// vismat import: makes a matrix file from a game's level.
#include <cstdio>
#include <map>
#include <memory>
#include <stdexcept>

#include "cli/summary.h"
#include "cli/verbs.h"
#include "cli/vmat_files.h"
#include "programs/options.h"
#include "visibility/geometry/bounding_volume_tree.h"
#include "visibility/levels/level_file.h"
#include "visibility/scene_file.h"

namespace vismat::cli {
namespace {

struct ImportArguments {
  std::string level, output, scene, matrix = "cells", tree = "bounds";
  bool nodes = false;
};

const std::map<std::string, LevelMatrix> matrices = {{"cells", LevelMatrix::cells},
                                                     {"faces", LevelMatrix::faces}};
const std::map<std::string, LevelTree> trees = {
    {"none", LevelTree::none}, {"bounds", LevelTree::bounds}, {"level", LevelTree::level}};

void write_faces(const Level& level, const ImportArguments& arguments) {
  SceneFile file;
  file.scene = level.face_scene;
  if (arguments.tree == "level") file.tree = level.face_tree;
  if (arguments.tree == "bounds") file.tree = bounding_volume_tree(level.face_bounds);
  file.provenance = level.name + ", " + level.format;
  write_scene(arguments.scene, file);
}

void print_scene(const Level& level, const ImportArguments& arguments) {
  const Scene& scene = level.face_scene;
  std::printf("%s: %s objects, %s triangles, %s see-through objects", arguments.scene.c_str(),
              grouped(scene.object_count).c_str(), grouped(scene.object_of_triangle.size()).c_str(),
              grouped(see_through_objects(scene)).c_str());
  for (const std::string& what : left_out_of_faces(level)) std::printf("; %s", what.c_str());
  std::printf("\n");
}

void run_import(const ImportArguments& arguments) {
  if (arguments.nodes && arguments.tree == "none") {
    throw std::invalid_argument("--nodes needs a tree: --tree bounds or --tree level");
  }
  const Level level = read_level(arguments.level, {.see_through = !arguments.scene.empty()});
  if (!arguments.scene.empty() && level.face_ids.empty()) {
    throw std::invalid_argument(arguments.level + ": a " + level.format +
                                " level without faces has no scene to write");
  }
  Dataset dataset = level_dataset(level, matrices.at(arguments.matrix), trees.at(arguments.tree));
  if (arguments.nodes) dataset = over_nodes(dataset);
  write_matrix(arguments.output, dataset);
  if (!arguments.scene.empty()) write_faces(level, arguments);
  const Shape shape = dataset.matrix.shape();
  std::printf("%s: %u %s x %u %s, %.1f %% visible", arguments.output.c_str(), shape.rows,
              plural_of(dataset.rows_are).c_str(), shape.columns, plural_of(dataset.columns_are).c_str(),
              dataset.matrix.density() * 100);
  if (dataset.source.tree) std::printf(", a tree of %u nodes", dataset.source.tree->size());
  for (const std::string& note : level.notes) std::printf("; %s", note.c_str());
  if (arguments.matrix == "faces" && level.faces_left_out > 0) {
    std::printf("; %u faces in no cluster left out", level.faces_left_out);
  }
  std::printf("\n");
  if (!arguments.scene.empty()) print_scene(level, arguments);
}

}  // namespace

void add_import(Program& program) {
  const auto arguments = std::make_shared<ImportArguments>();
  const Verb verb = program.verb("import", "Read a level of Quake 3 or Doom: what its view cells see");
  verb.input("LEVEL", arguments->level, "The level").required();
  verb.output(arguments->output, Written::matrix, "The matrix file to write (.bsp.h5, .mtx, .npy or .npz)");
  verb.option("--matrix", arguments->matrix,
              "What the columns are: cells (Quake's clusters, Doom's sectors), or faces (Quake only)")
      .one_of({"cells", "faces"});
  verb.option("--tree", arguments->tree,
              "The tree over the columns. none; bounds: a tree of bounding boxes with four children for each "
              "node; "
              "level: the level's own BSP tree")
      .one_of({"none", "bounds", "level"});
  verb.flag("--nodes", arguments->nodes, "Make the tree's nodes the columns");
  verb.output("--scene", arguments->scene, Written::scene,
              "Also write the faces' triangles as a scene file (.scene.h5), in which each face is an object");
  verb.note(
      "LEVEL is FILE.bsp, FILE.pk3:maps/NAME.bsp, FILE.wad:MAP or FILE.zip:NAME.wad:MAP; 'vismat info FILE' "
      "lists the levels of a file.");
  verb.example("vismat import pak1-maps.pk3:maps/oa_koth1.bsp -o koth1.bsp.h5 --matrix faces --tree level");
  verb.runs([arguments] { run_import(*arguments); });
}

}  // namespace vismat::cli
