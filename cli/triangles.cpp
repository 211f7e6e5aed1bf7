// vismat triangles: how many triangles a viewer draws, cell by cell.
#include <algorithm>
#include <cstdio>
#include <memory>
#include <numeric>
#include <span>
#include <stdexcept>

#include "cli/summary.h"
#include "cli/verbs.h"
#include "matrix/base/atomic_file.h"
#include "matrix/base/parallel.h"
#include "matrix/files/dataset_file.h"
#include "programs/progress.h"
#include "visibility/detail/levels_of_detail.h"
#include "visibility/meshes/any_scene.h"

namespace vismat::cli {
namespace {

struct Arguments {
  std::string scene, matrix, table;
  Screen screen;
  unsigned threads = 0;
};

struct Counts {
  std::uint64_t objects = 0, full = 0, at_level = 0, facing = 0;
};

/// "mean 25 901, median 24 011, most 98 110"
std::string spread(const std::vector<Counts>& cells, std::uint64_t Counts::*what) {
  std::vector<std::uint64_t> values;
  for (const Counts& counts : cells) values.push_back(counts.*what);
  if (values.empty()) return "none";
  std::sort(values.begin(), values.end());
  const std::uint64_t sum = std::accumulate(values.begin(), values.end(), std::uint64_t{0});
  return "mean " + grouped(sum / values.size()) + ", median " + grouped(values[values.size() / 2]) +
         ", most " + grouped(values.back());
}

void run(const Arguments& arguments) {
  const SceneFile file = read_any_scene(arguments.scene).file;
  const Dataset dataset = read_dataset(arguments.matrix);
  const Shape shape = dataset.matrix.shape(), right = {file.cells.count(), file.scene.object_count};
  if (dataset.source.columns_are_nodes || !dataset.source.boundaries.empty() || shape != right) {
    throw std::invalid_argument(arguments.matrix + ": need a matrix of the scene's " +
                                std::to_string(right.rows) + " view cells x " +
                                std::to_string(right.columns) + " objects");
  }
  const LevelsOfDetail levels(file.scene, arguments.screen, arguments.threads,
                              show_progress("making levels of detail"));
  const std::vector<Box> cells = cell_bounds(file.cells);
  std::vector<Counts> counts(shape.rows);
  parallel_for(
      shape.rows, arguments.threads,
      [&](std::uint64_t i) {
        const auto objects = dataset.matrix.row(static_cast<std::uint32_t>(i));
        counts[i].objects = objects.size();
        for (const std::uint32_t object : objects) {
          counts[i].full += levels.levels(object)[0].triangles.size();
          counts[i].at_level += levels.levels(object)[levels.level_for(cells[i], object)].triangles.size();
        }
        counts[i].facing = levels.visible_triangles(cells[i], objects);
      },
      show_progress("counting"));
  if (!arguments.table.empty()) {
    std::string text = "cell,objects,triangles,at_level_of_detail,facing\n";
    for (std::size_t i = 0; i < counts.size(); ++i) {
      text += std::to_string(i) + ',' + std::to_string(counts[i].objects) + ',' +
              std::to_string(counts[i].full) + ',' + std::to_string(counts[i].at_level) + ',' +
              std::to_string(counts[i].facing) + '\n';
    }
    write_file(arguments.table, std::as_bytes(std::span(text)));
  }
  line("triangles of the scene", grouped(file.scene.object_of_triangle.size()));
  line("visible objects a cell", spread(counts, &Counts::objects));
  line("their triangles", spread(counts, &Counts::full));
  line("at their level of detail", spread(counts, &Counts::at_level));
  line("less back faces", spread(counts, &Counts::facing));
}

}  // namespace

void add_triangles(CLI::App& app) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* verb = app.add_subcommand(
      "triangles", "How many triangles are drawn from each view cell, at levels of detail");
  verb->footer(
      "Each visible object at the coarsest level that no pixel shows from anywhere in the cell, without "
      "clusters that\n"
      "turn their backs on all of it [Chhugani et al. 2005, sections 4 and 5].\n"
      "Example: vismat triangles dense8.scene.h5 dense8.bsp.h5 --width 1280 --height 1024");
  verb->add_option("SCENE", arguments->scene, "A scene file, .scene.h5")->required();
  verb->add_option("MATRIX", arguments->matrix, "What its view cells see, over its objects")->required();
  const auto add = [&](const char* name, auto& value, const char* help) {
    verb->add_option(name, value, help)->capture_default_str();
  };
  add("--width", arguments->screen.width, "Of the picture, pixels");
  add("--height", arguments->screen.height, "Of the picture, pixels");
  add("--field-of-view", arguments->screen.field_of_view, "Degrees, along the width");
  add("--threads", arguments->threads, "0: one a core; the result is the same for any number");
  verb->add_option("-o,--output", arguments->table, "The counts of each cell as a table, .csv");
  verb->callback([arguments] { run(*arguments); });
}

}  // namespace vismat::cli
