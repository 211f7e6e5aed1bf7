// Makes a matrix of view cells against octants: what a viewer sees of a scene that an engine keeps in an octree.
//
// A column is an occupied octant of one level of the octree; it is seen if some triangle in it is. A row is a view cell where a
// viewer can be: in a level, a box that has a point in some cluster; elsewhere a box that viewers from the sky or from --from
// reach; or a view cell of the scene's own. All of it is sized by two numbers, the most octants and the most view cells.
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <variant>
#include <vector>

#include <glm/vec3.hpp>

#include "bench/verbs.h"
#include "matrix/files/dataset_file.h"
#include "programs/measuring.h"
#include "programs/progress.h"
#include "visibility/cells/cells_choice.h"
#include "visibility/generators/dense_city.h"
#include "visibility/generators/plant.h"
#include "visibility/geometry/touching_boxes.h"
#include "visibility/levels/level_file.h"
#include "visibility/meshes/any_scene.h"
#include "visibility/meshes/octants.h"
#include "visibility/producers/bounds.h"
#include "visibility/producers/producers.h"

namespace vismat::bench {
namespace {

struct OctantsOptions {
  std::string level, producer = "sampled";
  CellsWords cells{"auto", {}, {}, {}};
  std::uint32_t octants = 3000, view_cells = 3000;
  ProducerOptions see;
  std::filesystem::path output;
};

struct SceneToCut {
  SceneFile file;
  std::optional<Level> level;  // if it is one, and tells what lies within it
};

SceneToCut read_whole(const std::string& name, unsigned threads) {
  if (name == "dense-city") return {make_dense_city(), {}};
  if (name == "plant") {
    PlantOptions options;
    options.size = 3;
    return {make_plant(options, threads), {}};
  }
  SceneToCut whole{read_any_scene(name).file, {}};
  if (names_level(name)) whole.level = read_level(name, {.visibility = false});
  if (whole.level && whole.level->places.nodes.empty()) whole.level.reset();
  return whole;
}

/// Points inside of the level, one in each cluster whose box has its middle there.
std::vector<glm::vec3> points_within(const Level& level, const Box& region) {
  std::vector<glm::vec3> points;
  for (std::size_t cell = 0; cell < level.cell_bounds.size(); ++cell) {
    const auto middle = centre_of(level.cell_bounds[cell]);
    const glm::vec3 point(middle[0], middle[1], middle[2]);
    if (meet(region, {middle, middle}) && cell_at(level.places, point) == static_cast<std::int32_t>(cell))
      points.push_back(point);
  }
  return points;
}

/// The cells that the words ask for. Rays and walls alone cannot tell what is within a level, whose outer faces are not drawn.
ViewCells cells_of(const SceneToCut& whole, CellsWords words) {
  const Scene& scene = whole.file.scene;
  CellsChoice choice = parse_cells(words, whole.file.origin);
  const auto start = [&](auto& options) {
    if constexpr (!std::is_same_v<std::decay_t<decltype(options)>, std::monostate>) {
      if (whole.level && options.viewers.from.empty())
        options.viewers.from = points_within(*whole.level, bounds_of(scene));
    }
  };
  std::visit(start, choice);
  ThreadJobRunner runner;
  const VisibleTriangles count = [&](const ViewCells& cells) {
    return triangles_of_rows(see_bounds(scene, cells, effort(0), runner).not_hidden, scene);
  };
  ViewCells cells = choose_cells(scene, whole.file.cells, choice, count).cells;
  if (whole.level && std::erase_if(cells.boxes, [&](const Box& box) {
                       return !has_point_in_cell(whole.level->places, box);
                     }) > 0)
    cells.neighbours = touching_boxes(cell_bounds(cells));
  return cells;
}

/// The scene's own view cells; otherwise boxes, the smallest of which there are not too many.
ViewCells view_cells_of(const SceneToCut& whole, const OctantsOptions& options) {
  if (options.cells.cells != "auto") return cells_of(whole, options.cells);
  if (whole.file.cells.count() > 0) return whole.file.cells;
  const Box bounds = bounds_of(whole.file.scene);
  double side = 0;
  for (unsigned axis = 0; axis < 3; ++axis)
    side = std::max(side, double{bounds.high[axis]} - bounds.low[axis]);
  const auto grid = [&](double size) {
    CellsWords words = options.cells;
    std::array<char, 32> text;
    std::snprintf(text.data(), text.size(), "grid:%.3g", size);
    words.cells = text.data();
    return cells_of(whole, words);
  };
  ViewCells cells = grid(side /= 4);
  while (true) {
    side /= 1.25;
    ViewCells smaller = grid(side);
    if (smaller.count() > options.view_cells) return cells;
    cells = std::move(smaller);
  }
}

/// As many octants as there may be, or little less: halving them alone would leave a quarter.
Octants octants_of(const Scene& scene, std::uint32_t most) {
  Octants octants = cut_into_octants(scene, most);
  for (const double scale : {1.25, 1.5, 1.75}) {
    Octants other = cut_into_octants(scene, most, 20, scale);
    if (other.count() > octants.count()) octants = std::move(other);
  }
  return octants;
}

VisibilityMatrix over_octants(const VisibilityMatrix& objects, const Octants& octants) {
  std::vector<std::vector<std::uint32_t>> rows(objects.shape().rows);
  for (std::uint32_t r = 0; r < rows.size(); ++r) {
    for (const std::uint32_t object : objects.row(r)) {
      const std::uint32_t octant = octants.octant_of_object[object];
      if (rows[r].empty() || rows[r].back() != octant) rows[r].push_back(octant);
    }
  }
  return VisibilityMatrix::from_rows(rows, octants.count());
}

void run_octants(OctantsOptions options) {
  const Producer& producer = producer_named(options.producer);
  check_taken(producer, options.see);
  if (!options.see.rays && producer.takes(&ProducerOptions::rays)) options.see.rays = 1000;
  const SceneToCut whole = read_whole(options.level, options.see.threads);
  const Octants octants = octants_of(whole.file.scene, options.octants);
  const ViewCells cells = view_cells_of(whole, options);
  const double side = double{octants.boxes[0].high[0]} - octants.boxes[0].low[0];
  std::printf("%s: %u octants of %.3g m, in %zu triangles; %u view cells\n", options.level.c_str(),
              octants.count(), side, octants.scene.object_of_triangle.size(), cells.count());
  std::fflush(stdout);

  ThreadJobRunner runner(options.see.threads);
  const double start = processor_seconds();
  const Sight sight = producer.see(octants.scene, cells, options.see, runner,
                                   [](const char* stage) { return cli::show_progress(stage); });
  Dataset dataset;
  dataset.matrix = over_octants(producer.listed(sight), octants);
  dataset.columns_are = "octant";
  std::array<char, 64> made;
  std::snprintf(made.data(), made.size(), "; %u octants of %.9g m; of ", octants.count(), side);
  dataset.provenance = producer.describe(options.see) + made.data() + whole.file.provenance;
  dataset.guarantee = producer.guarantee;
  dataset.seed = options.see.seed.value_or(1);
  dataset.row_bounds = cell_bounds(cells);
  dataset.column_bounds = octants.boxes;
  dataset.row_neighbours = cells.neighbours;
  dataset.source.column_names = octants.paths;
  write_dataset(options.output, dataset);
  std::printf("%s: %.2f %% visible, %s; %.0f s of processor time\n", options.output.c_str(),
              100 * dataset.matrix.density(), std::string(to_string(dataset.guarantee)).c_str(),
              processor_seconds() - start);
  if (sight.held_back && sight.held_back->rays > 0) {
    std::printf(
        "  other rays: %.3f %% of the view shows what is not listed\n",
        100 * static_cast<double>(sight.held_back->missed_rays) / static_cast<double>(sight.held_back->rays));
  }
}

}  // namespace

void add_octants(const Verb& verb) {
  const auto o = std::make_shared<OctantsOptions>();
  verb.input("LEVEL", o->level,
             "A Quake 3 level, a scene file or a mesh; or dense-city or plant, which are generated")
      .required();
  verb.output(o->output, Written::matrix, "The matrix file to write (.bsp.h5, .mtx, .npy or .npz)");
  verb.option("--octants", o->octants,
              "Most columns: the octree is divided as long as no more of its smallest octants are occupied")
      .positive();
  verb.option("--view-cells", o->view_cells,
              "Most rows, where --cells is auto: boxes are the smallest that are no more")
      .positive();
  verb.option("--cells", o->cells.cells,
              "View cells as for 'vismat see': file, grid:SIZE, ground, octree:TRIANGLES ...; or auto: those "
              "of the scene, or else a grid");
  verb.option("--from", o->cells.from,
              "A point x,y,z from which viewers come; may be given several times (default: a level's "
              "clusters, elsewhere the sky)")
      .repeatable();
  verb.option("--producer", o->producer,
              "Method, as for 'vismat see': sampled misses slivers, sandwich and shadow list too much");
  verb.option("--rays", o->see.rays,
              "Most rays that are aimed from each view cell in each round (default: 1000)");
  verb.option("--seed", o->see.seed, "Seed of the rays (default: 1)");
  verb.threads(o->see.threads);
  verb.example(
      "bench octants pak1-maps.pk3:maps/oa_koth1.bsp --octants 6000 --view-cells 6000 -o "
      "koth1.octants.bsp.h5");
  verb.runs([o] { run_octants(*o); });
}

}  // namespace vismat::bench
