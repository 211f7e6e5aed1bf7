// vismat triangles: counts the triangles that are drawn from each view cell.
#include <algorithm>
#include <cstdio>
#include <memory>
#include <numeric>
#include <span>
#include <stdexcept>

#include "cli/summary.h"
#include "cli/verbs.h"
#include "cli/vmat_files.h"
#include "matrix/base/atomic_file.h"
#include "matrix/base/parallel.h"
#include "programs/options.h"
#include "programs/progress.h"
#include "visibility/detail/levels_of_detail.h"
#include "visibility/meshes/any_scene.h"

namespace vismat::cli {
namespace {

struct TrianglesArguments {
  std::string scene, matrix, table;
  Screen screen;
  unsigned threads = 0;
};

struct Counts {
  std::uint64_t objects = 0, full = 0, at_level = 0, facing = 0;
  std::uint64_t too_coarse = 0;  // objects whose level deviates by a pixel or more
};

/// The counts as text: "mean 25 901, median 24 011, most 98 110".
std::string spread(const std::vector<Counts>& cells, std::uint64_t Counts::*what) {
  std::vector<std::uint64_t> values;
  for (const Counts& counts : cells) values.push_back(counts.*what);
  if (values.empty()) return "none";
  std::sort(values.begin(), values.end());
  const std::uint64_t sum = std::accumulate(values.begin(), values.end(), std::uint64_t{0});
  return "mean " + grouped(sum / values.size()) + ", median " + grouped(values[values.size() / 2]) +
         ", most " + grouped(values.back());
}

void run_triangles(const TrianglesArguments& arguments) {
  const AnyScene read = read_any_scene(arguments.scene);
  const SceneFile& file = read.file;
  Dataset dataset = read_matrix(arguments.matrix);
  // Which column is which object at which level is told in the source's numbers, unless columns are objects.
  if (!dataset.source.column_levels.empty() && dataset.source.boundaries.empty())
    dataset = in_source_numbers(std::move(dataset));
  const std::vector<ObjectLevel>& columns = dataset.source.column_levels;
  const Shape shape = dataset.matrix.shape(),
              right = {file.cells.count(), columns.empty() ? file.scene.object_count : shape.columns};
  if (dataset.source.columns_are_nodes || !dataset.source.boundaries.empty() || shape != right) {
    throw std::invalid_argument(arguments.matrix + ": the matrix must be of the scene's " +
                                std::to_string(right.rows) + " view cells x " +
                                std::to_string(file.scene.object_count) +
                                " objects, or x objects at levels of detail");
  }
  const LevelsOfDetail levels(file.scene, arguments.screen, arguments.threads,
                              show_progress("making levels of detail"));
  for (const auto& [object, level] : columns) {
    if (object >= levels.object_count() || level >= levels.levels(object).size()) {
      throw std::invalid_argument(arguments.matrix + ": has level " + std::to_string(level) + " of object " +
                                  std::to_string(object) + ", which the scene has not");
    }
  }
  const std::vector<Box> cells = cell_bounds(file.cells);
  std::vector<Counts> counts(shape.rows);
  parallel_for(
      shape.rows, arguments.threads,
      [&](std::uint64_t i) {
        const auto objects = dataset.matrix.row(static_cast<std::uint32_t>(i));
        counts[i].objects = objects.size();
        for (const std::uint32_t column : objects) {
          const std::uint32_t object = columns.empty() ? column : columns[column].object,
                              fine = levels.level_for(cells[i], object),
                              level = columns.empty() ? fine : columns[column].level;
          counts[i].full += levels.levels(object)[0].triangles.size();
          counts[i].at_level += levels.levels(object)[level].triangles.size();
          counts[i].facing += levels.facing_triangles(cells[i], object, level);
          counts[i].too_coarse += level > fine;
        }
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
  line("visible objects per cell", spread(counts, &Counts::objects));
  line("their triangles", spread(counts, &Counts::full));
  line("at their level of detail", spread(counts, &Counts::at_level));
  line("without back faces", spread(counts, &Counts::facing));
  if (!columns.empty()) {
    line("too coarse for the picture", spread(counts, &Counts::too_coarse) + " objects per cell");
  }
  print_notes(read);
}

}  // namespace

void add_triangles(Program& program) {
  const auto arguments = std::make_shared<TrianglesArguments>();
  const Verb verb = program.verb(
      "triangles", "Count the triangles that are drawn from each view cell, with levels of detail");
  verb.input("SCENE", arguments->scene, "The scene file (.scene.h5)").required();
  verb.input("MATRIX", arguments->matrix,
             "The matrix of its view cells and objects (made with 'vismat see --objects'), or objects at "
             "levels of "
             "detail (--levels)")
      .required();
  verb.option("--width", arguments->screen.width, "Width of the picture in pixels");
  verb.option("--height", arguments->screen.height, "Height of the picture in pixels");
  verb.option("--field-of-view", arguments->screen.field_of_view, "Horizontal field of view in degrees");
  verb.threads(arguments->threads);
  verb.output("-o,--output", arguments->table, Written::text,
              "Also write the counts of each view cell as a table (.csv)");
  verb.note(
      "Each visible object is counted at the coarsest level of detail whose error stays below a pixel, seen "
      "from anywhere in the view cell. Groups of triangles that face away from the whole view cell are not "
      "counted [Chhugani et al. 2005, sections 4 and 5]. If the matrix says at which level it lists an "
      "object, "
      "that level is counted, whatever the picture is.");
  verb.example("vismat triangles dense8.scene.h5 dense8.bsp.h5 --width 1280 --height 1024");
  verb.runs([arguments] { run_triangles(*arguments); });
}

}  // namespace vismat::cli
