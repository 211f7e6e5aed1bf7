// vismat cells: view cells for a scene.
#include <cstdio>
#include <memory>
#include <numeric>
#include <optional>
#include <stdexcept>

#include "cli/cells_options.h"
#include "cli/verbs.h"
#include "matrix/base/parallel.h"
#include "programs/progress.h"
#include "visibility/detail/levels_of_detail.h"
#include "visibility/meshes/any_scene.h"
#include "visibility/rays/aimed_rays.h"
#include "visibility/scene_file.h"

namespace vismat::cli {
namespace {

struct Arguments {
  std::string scene, output;
  CellsWords cells;
  float resize = 1;
  std::uint32_t rays = 16;
  bool drawn = false;
  unsigned threads = 0;
};

/// Triangles of the objects that rays find from each cell, a lower bound: all of them, or those that are drawn if there are
/// levels of detail. Keeps what it is given.
VisibleTriangles count_by_rays(const Scene& scene, const AimedRays& rays, const LevelsOfDetail* drawn,
                               const Arguments& arguments) {
  return [&, drawn, level = 0](const ViewCells& cells) mutable {
    std::vector<std::uint32_t> everything(scene.object_count);
    std::iota(everything.begin(), everything.end(), 0u);
    std::vector<std::vector<std::uint32_t>> seen(cells.count());
    const auto look = [&](std::uint64_t i) {
      const auto cell = static_cast<std::uint32_t>(i);
      const CellPoints points(convex_of(cells, cell));
      const std::uint64_t budget = std::uint64_t{arguments.rays} * scene.object_count;
      for (const SeenObject& object : rays.from(points, everything, budget, Random(1, cell)).objects)
        seen[cell].push_back(object.object);
    };
    parallel_for(cells.count(), arguments.threads, look,
                 show_progress("looking around on level " + std::to_string(level++)));
    if (drawn == nullptr)
      return triangles_of_rows(VisibilityMatrix::from_rows(seen, scene.object_count), scene);
    const std::vector<Box> boxes = cell_bounds(cells);
    std::vector<std::uint64_t> triangles(boxes.size());
    parallel_for(boxes.size(), arguments.threads,
                 [&](std::uint64_t i) { triangles[i] = drawn->visible_triangles(boxes[i], seen[i]); });
    return triangles;
  };
}

void run(const Arguments& arguments) {
  if (!(arguments.resize > 0 && arguments.resize <= 1000)) {
    throw std::invalid_argument("--resize must be above 0 and at most 1000");
  }
  const CellsChoice choice = parse_cells(arguments.cells);
  SceneFile file = read_any_scene(arguments.scene).file;
  const RayCaster caster(file.scene);
  const AimedRays rays(file.scene, caster);
  std::optional<LevelsOfDetail> drawn;
  if (arguments.drawn && std::holds_alternative<OctreeCellsOptions>(choice)) {
    drawn.emplace(file.scene, Screen{}, arguments.threads, show_progress("making levels of detail"));
  }
  ChosenCells chosen = choose_cells(file.scene, file.cells, choice,
                                    count_by_rays(file.scene, rays, drawn ? &*drawn : nullptr, arguments));
  file.cells = std::move(chosen.cells);
  std::string made = "; " + describe(choice);
  if (std::holds_alternative<OctreeCellsOptions>(choice)) {
    made += ", counted by " + std::to_string(arguments.rays) + " rays an object";
    if (drawn) made += ", at levels of detail without back faces";
  }
  if (arguments.resize != 1) {
    file.cells = resized(file.cells, arguments.resize);
    char text[32];
    std::snprintf(text, sizeof text, ", resized by %g", arguments.resize);
    made += text;
  }
  file.provenance += made;
  write_scene(arguments.output, file);
  std::fputs(chosen.table.c_str(), stdout);
  std::printf("%s: %u view cells\n", arguments.output.c_str(), file.cells.count());
}

}  // namespace

void add_cells_options(CLI::App& verb, CellsWords& words) {
  verb.add_option("--cells", words.cells,
                  "file: the scene's own; grid:SIZE or grid:X,Y,Z metres; ground, or ground:HEIGHT where the "
                  "scene has none; octree:TRIANGLES[:LEVELS], refined while more triangles are visible")
      ->capture_default_str();
  verb.add_option("--region", words.region,
                  "Where cells are: x,y,z,x,y,z, low corner and high (the scene's bounds)");
  verb.add_option(
          "--from", words.from,
          "A point x,y,z from which viewers come; repeatable (default: from the sky, or the largest ground)")
      ->allow_extra_args(false);
  verb.add_option(
      "--eyes", words.eyes,
      "Viewers stand, eyes LOW[,HIGH] metres above the ground (default: they fly; on ground cells 1.6)");
}

void add_cells(CLI::App& app) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* verb = app.add_subcommand("cells", "Make view cells for a scene, wherever a viewer can be");
  verb->footer(
      "Example: vismat cells city.scene.h5 --cells grid:4,4,1.5 --region 0,0,1,640,640,2.5 -o grid.scene.h5");
  verb->add_option("SCENE", arguments->scene,
                   "A scene file, a mesh (.obj, .ply, .off, .stl) or a Quake-3 level")
      ->required();
  add_cells_options(*verb, arguments->cells);
  verb->add_option("--resize", arguments->resize,
                   "Each cell so many times as large about its middle: the same places, other cells")
      ->capture_default_str();
  verb->add_option("--rays", arguments->rays, "To count an octree's visible triangles, an object and cell")
      ->check(CLI::Range(1u, 1000000u))
      ->capture_default_str();
  verb->add_flag("--drawn", arguments->drawn,
                 "Count for an octree what is drawn: at levels of detail, without back faces");
  verb->add_option("--threads", arguments->threads, "0: one a core; the result is the same for any number")
      ->capture_default_str();
  verb->add_option("-o,--output", arguments->output, "The scene file to write (.scene.h5)")->required();
  verb->callback([arguments] { run(*arguments); });
}

}  // namespace vismat::cli
