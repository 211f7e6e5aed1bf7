// Measures the adaptive octree of Chhugani et al. 2005, sections 3 and 8, on our scenes: the view cells of each level of
// the octree, how many of the smallest still see more triangles than the threshold, and how many times as many.
//
// The triangles of a view cell are those that must be drawn from it: of each object that shadows of effort 0 do not hide, in the
// coarsest level of detail allowed there, without the groups of triangles that face away.
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "bench/verbs.h"
#include "bench/visibility_study.h"
#include "matrix/base/parallel.h"
#include "programs/csv.h"
#include "visibility/cells/octree_cells.h"
#include "visibility/detail/levels_of_detail.h"
#include "visibility/generators/dense_city.h"

namespace vismat::bench {
namespace {

struct OctreeTablesOptions {
  std::vector<std::string> scenes;
  std::vector<double> shares = {.15, .2, .25, .3};
  std::filesystem::path csv;
  unsigned levels = 5;
};

SceneFile octree_scene(const std::string& name) {
  if (name != "dense-city") return study_scene(name);
  DenseCityOptions options;  // a quarter of the study's, since levels of detail take long
  options.size = 10;
  return make_dense_city(options);
}

std::string lines_of(const std::string& name, const std::vector<double>& shares, unsigned levels) {
  const SceneFile file = octree_scene(name);
  const LevelsOfDetail lods(file.scene);
  const Shadows shadows(file.scene, find_occluders(file.scene));
  ThreadJobRunner runner;
  const VisibleTriangles count = [&](const ViewCells& cells) {
    const Sight sight = see_bounds(shadows, nullptr, cells, effort(0), runner);
    std::vector<std::uint64_t> triangles(cells.count());
    parallel_for(cells.count(), 0, [&](std::uint64_t i) {
      triangles[i] =
          lods.visible_triangles(cells.boxes[i], sight.not_hidden.row(static_cast<std::uint32_t>(i)));
    });
    return triangles;
  };
  std::string csv;
  for (const double share : shares) {
    const auto threshold = static_cast<std::uint64_t>(
        std::round(share * static_cast<double>(file.scene.object_of_triangle.size())));
    OctreeCellsOptions options;
    options.threshold = threshold;
    options.levels = levels;
    options.region = bounds_of(file.scene);
    const OctreeCells octree = make_octree_cells(file.scene, count, options);
    std::uint64_t sum = 0;
    for (const std::uint64_t triangles : octree.triangles) sum += triangles;
    for (std::size_t level = 0; level < octree.levels.size(); ++level) {
      const OctreeLevel& now = octree.levels[level];
      csv += csv_line(name, file.scene.object_of_triangle.size(), threshold, level,
                      octree.side / static_cast<double>(1u << level), now.evaluated, now.kept, now.stopped,
                      now.excess, octree.cells.count(),
                      static_cast<double>(sum) / static_cast<double>(octree.cells.count()));
    }
    std::printf("%s, threshold %ju: %u cells\n%s", name.c_str(), std::uintmax_t{threshold},
                octree.cells.count(), table_of(octree).c_str());
    std::fflush(stdout);
  }
  return csv;
}

void run_octree_tables(const OctreeTablesOptions& options) {
  std::string csv =
      "scene,triangles,threshold,level,side,evaluated,kept,stopped,excess,cells,mean_triangles\n";
  for (const std::string& scene : options.scenes) {
    csv += lines_of(scene, options.shares, options.levels);
    write_table(options.csv, csv);
  }
}

}  // namespace

void add_octree_tables(const Verb& verb) {
  const auto o = std::make_shared<OctreeTablesOptions>();
  verb.input("SCENE", o->scenes,
             "Scenes as for visibility-tables; dense-city is here only a quarter as large")
      .required();
  verb.option("--share", o->shares,
              "Thresholds, as shares of the scene's triangles: a view cell that sees more is divided")
      .comma_separated();
  verb.option("--levels", o->levels, "How often a view cell is divided at most");
  verb.output("--csv", o->csv, Written::text, "File for the tables as CSV");
  verb.example("bench octree-tables dense-city --share 0.2 --levels 4 --csv octree.csv");
  verb.runs([o] { run_octree_tables(*o); });
}

}  // namespace vismat::bench
