// vismat see: a scene file to a visibility matrix, by rays.
#include <algorithm>
#include <cstdio>
#include <limits>
#include <memory>
#include <stdexcept>

#include "cli/progress.h"
#include "cli/verbs.h"
#include "visibility/any_scene.h"
#include "visibility/ray_sampling.h"

namespace vismat::cli {
namespace {

struct Arguments {
  std::string scene, output;
  RaySamplingOptions options;
  bool nodes = false, objects = false;
};

void run(const Arguments& arguments) {
  SceneFile file = read_any_scene(arguments.scene).file;
  if (arguments.nodes && !file.tree) {
    throw std::invalid_argument(arguments.scene + ": has no tree, so --nodes cannot be; use --objects");
  }
  SeenByRays seen = see_by_rays(file.scene, file.cells, arguments.options, show_progress("looking around"));
  std::uint64_t late = 0;
  for (const std::uint32_t yield : seen.last_yield) late += yield;
  const double share = seen.objects.ones() == 0
                           ? 0
                           : 100 * static_cast<double>(late) / static_cast<double>(seen.objects.ones());

  Dataset dataset;
  dataset.matrix = std::move(seen.objects);
  dataset.provenance = describe(arguments.options) + "; of " + file.provenance;
  dataset.guarantee = Guarantee::aggressive;
  dataset.seed = arguments.options.seed;
  dataset.row_bounds = cell_bounds(file.cells);
  dataset.column_bounds = object_bounds(file.scene);
  dataset.row_neighbours = std::move(file.cells.neighbours);
  dataset.tree = std::move(file.tree);
  if (dataset.tree && !arguments.objects) dataset = over_nodes(dataset);
  write_dataset(arguments.output, dataset);
  const Shape shape = dataset.matrix.shape();
  std::printf("%s: %u view cells x %u %s, %.2f %% visible; %llu rays, the last pass found %.2f %%\n",
              arguments.output.c_str(), shape.rows, shape.columns,
              dataset.columns_are_nodes ? "nodes" : "objects", 100 * dataset.matrix.density(),
              static_cast<unsigned long long>(seen.rays), share);
}

}  // namespace

void add_see(CLI::App& app) {
  auto arguments = std::make_shared<Arguments>();
  RaySamplingOptions& o = arguments->options;
  CLI::App* verb = app.add_subcommand("see", "Find by rays which objects each view cell of a scene sees");
  verb->footer(
      "What is found is really visible; slivers may be missed (guarantee: aggressive).\n"
      "Example: vismat see city32.scene.h5 -o city32.bsp.h5");
  verb->add_option("scene", arguments->scene,
                   "A scene file, a mesh (.obj, .ply, .off, .stl) or a Quake-3 level")
      ->required();
  verb->add_option("-o,--output", arguments->output, "The matrix to write (.bsp.h5 or .mtx)")->required();
  const auto add = [&](const char* name, auto& value, const char* help) {
    verb->add_option(name, value, help)->capture_default_str();
  };
  add("--seed", o.seed, "Another seed, other rays");
  add("--rays", o.directions, "Unaimed directions all around a viewpoint, in the first pass");
  add("--viewpoints", o.origins, "Viewpoints an edge of a cell and pass");
  add("--passes", o.passes, "At most");
  add("--enough", o.enough_yield, "A cell rests when a pass adds less than this part of what it sees");
  add("--threads", o.threads, "0: one a core; the result is the same for any number");
  CLI::Option* nodes = verb->add_flag("--nodes", arguments->nodes,
                                      "One column a node of the scene's tree (the default where it has one)");
  verb->add_flag("--objects", arguments->objects, "One column an object")->excludes(nodes);
  verb->callback([arguments] { run(*arguments); });
}

}  // namespace vismat::cli
