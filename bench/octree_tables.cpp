// The adaptive octree of Chhugani et al. 2005, sections 3 and 8, on our scenes: cells of each level, how many of the smallest would
// have to be smaller yet, and by how much they pass the threshold.
//
//   octree_tables --csv FILE --share S,... SCENE ...
//
// A cell's triangles are those of its vLOD: objects that shadows of effort 0 do not hide, each in the level of detail and with the
// faces that the cell allows.
#include <CLI/CLI.hpp>

#include "bench/visibility_study.h"
#include "matrix/base/atomic_file.h"
#include "visibility/cells/octree_cells.h"
#include "visibility/detail/levels_of_detail.h"

namespace {

using namespace vismat;
using namespace vismat::bench;

SceneFile octree_scene(const std::string& name) {
  if (name != "dense-city") return study_scene(name);
  DenseCityOptions options;  // a quarter of the study's: levels of detail take 15 us a triangle
  options.size = 10;
  return make_dense_city(options);
}

std::string lines_of(const std::string& name, const std::vector<double>& shares, unsigned levels) {
  const SceneFile file = octree_scene(name);
  const LevelsOfDetail lods(file.scene);
  const Shadows shadows(file.scene, find_occluders(file.scene));
  ThreadCrew crew;
  const VisibleTriangles count = [&](const ViewCells& cells) {
    const Sight sight = see_bounds(shadows, nullptr, cells, effort(0), crew);
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

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("The adaptive octree of view cells, level by level");
  std::vector<std::string> scenes;
  std::vector<double> shares = {.15, .2, .25, .3};
  std::filesystem::path csv_file;
  unsigned levels = 5;
  app.add_option("SCENES", scenes, "As for visibility_tables; the dense city is a quarter of it")->required();
  app.add_option("--share", shares, "Of the scene's triangles: a cell is refined where more are visible")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->capture_default_str();
  app.add_option("--levels", levels, "Of refinement, at most")->capture_default_str();
  app.add_option("--csv", csv_file, "Written beside the tables");
  CLI11_PARSE(app, argc, argv);
  try {
    std::string csv =
        "scene,triangles,threshold,level,side,evaluated,kept,stopped,excess,cells,mean_triangles\n";
    for (const std::string& scene : scenes) {
      csv += lines_of(scene, shares, levels);
      if (!csv_file.empty()) write_file(csv_file, std::as_bytes(std::span(csv)));
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "octree_tables: %s\n", error.what());
    return 1;
  }
}
