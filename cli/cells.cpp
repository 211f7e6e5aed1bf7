// vismat cells: makes view cells for a scene.
#include <cstdio>
#include <memory>
#include <numeric>
#include <optional>
#include <string>

#include "cli/cells_options.h"
#include "cli/summary.h"
#include "cli/verbs.h"
#include "matrix/base/parallel.h"
#include "programs/options.h"
#include "programs/progress.h"
#include "visibility/cells/ground_triangles.h"
#include "visibility/detail/levels_of_detail.h"
#include "visibility/meshes/any_scene.h"
#include "visibility/meshes/level_faces.h"
#include "visibility/rays/aimed_rays.h"
#include "visibility/scene_file.h"

namespace vismat::cli {
namespace {

struct CellsArguments {
  std::string scene, output;
  CellsWords cells;
  float resize = 1;
  std::uint32_t rays = 16;
  bool drawn = false;
  unsigned threads = 0;
};

/// The number of triangles of the objects that rays find from each view cell, which is a lower bound: all of them, or those that are
/// drawn if there are levels of detail. Keeps references to its arguments.
VisibleTriangles count_by_rays(const Scene& scene, const AimedRays& rays, const LevelsOfDetail* drawn,
                               const CellsArguments& arguments) {
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
                 show_progress("casting rays on level " + std::to_string(level++)));
    if (drawn == nullptr)
      return triangles_of_rows(VisibilityMatrix::from_rows(seen, scene.object_count), scene);
    const std::vector<Box> boxes = cell_bounds(cells);
    std::vector<std::uint64_t> triangles(boxes.size());
    parallel_for(boxes.size(), arguments.threads,
                 [&](std::uint64_t i) { triangles[i] = drawn->visible_triangles(boxes[i], seen[i]); });
    return triangles;
  };
}

/// The area that the cells take as seen from above; boxes that stand above one another count once each, in m2.
double plan_area(const ViewCells& cells) {
  double area = 0;
  for (std::size_t c = 0; c < cells.corners.size(); c += 3) {
    area += area_in_plan({cells.corners[c], cells.corners[c + 1], cells.corners[c + 2]});
  }
  for (const Box& box : cells.boxes) area += double{box.high[0] - box.low[0]} * (box.high[1] - box.low[1]);
  return area;
}

void run_cells(const CellsArguments& arguments) {
  parse_cells(arguments.cells);  // refuses what cannot be before the scene is read
  AnyScene read = read_any_scene(arguments.scene);
  SceneFile& file = read.file;
  const CellsChoice choice = parse_cells(arguments.cells, file.origin);
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
  std::printf("%s: %u view cells over %.4g m2 of the plan\n", arguments.output.c_str(), file.cells.count(),
              plan_area(file.cells));
  print_notes(read);
  if (const int up = axis_of_level_faces(file.scene); up != 2) {
    line("note", std::string("most level faces of the scene look along ") + "xyz"[up] +
                     ", not z: view cells may stand on walls; vismat scene --up y turns a mesh");
  }
}

}  // namespace

void add_cells_options(const Verb& verb, CellsWords& words) {
  verb.option(
      "--cells", words.cells,
      "The view cells. file: those of the scene file; grid:SIZE or grid:X,Y,Z: boxes of that size in "
      "metres; ground: triangles of the ground, or ground:HEIGHT where the scene has no ground; "
      "octree:TRIANGLES[:LEVELS]: boxes that are divided as long as more than TRIANGLES triangles are "
      "visible from them, at most LEVELS times");
  verb.option(
      "--region", words.region,
      "Where view cells may be: x,y,z,x,y,z, the low corner and the high one (default: the scene's bounds). "
      "Boxes of a grid become evenly smaller so that they end with the region; those of an octree are cut "
      "there");
  verb.option("--from", words.from,
              "A point x,y,z from which viewers come; may be given several times (default: the sky, or the "
              "largest piece of ground)")
      .repeatable();
  verb.option("--eyes", words.eyes,
              "Viewers stand, with their eyes LOW[,HIGH] metres above the ground (default: 1.6 on ground "
              "cells; elsewhere viewers fly)");
}

void add_cells(Program& program) {
  const auto arguments = std::make_shared<CellsArguments>();
  const Verb verb = program.verb("cells", "Make view cells for a scene, wherever a viewer can be");
  verb.input("SCENE", arguments->scene, "A scene file, a mesh (.obj, .ply, .off, .stl) or a Quake 3 level")
      .required();
  add_cells_options(verb, arguments->cells);
  verb.option("--resize", arguments->resize,
              "Multiply the size of each view cell by this, about its middle; the cells then overlap or "
              "leave gaps")
      .between(1e-3, 1000);
  verb.option("--rays", arguments->rays,
              "Number of rays for each object and view cell that count an octree's visible triangles")
      .between(1, 1000000);
  verb.flag("--drawn", arguments->drawn,
            "Count for an octree the triangles that are drawn: at levels of detail and without back faces");
  verb.threads(arguments->threads);
  verb.output(arguments->output, Written::scene, "The scene file to write (.scene.h5)");
  verb.example("vismat cells city.scene.h5 --cells grid:4,4,1.5 --region 0,0,1,640,640,2.5 -o grid.scene.h5");
  verb.runs([arguments] { run_cells(*arguments); });
}

}  // namespace vismat::cli
