// vismat see: makes a visibility matrix from any triangles.
#include <algorithm>
#include <cstdio>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>

#include "cli/cells_options.h"
#include "cli/summary.h"
#include "cli/verbs.h"
#include "matrix/base/checksum.h"
#include "matrix/files/dataset_file.h"
#include "programs/jobs.h"
#include "programs/options.h"
#include "programs/progress.h"
#include "visibility/detail/levels_of_detail.h"
#include "visibility/meshes/any_scene.h"
#include "visibility/producers/see.h"
#include "visibility/rays/ray_sampling.h"

namespace vismat::cli {
namespace {

struct Arguments {
  std::string scene, output, seen, producer = "sandwich";
  CellsWords cells;
  unsigned effort = 1, threads = 0;
  std::optional<std::uint32_t> points, patches, resolution, patch_resolution;
  std::optional<std::uint64_t> rays, patch_rays;
  std::uint64_t seed = 1;
  RaySamplingOptions climbing;
  bool nodes = false, objects = false;
};

BoundsOptions bounds_options(const Arguments& arguments) {
  const bool shadow = arguments.producer == "shadow";
  BoundsOptions options = effort(arguments.effort);
  if (shadow) {
    options.sampled.reset();
    options.patch_rays = 0;
  } else if (!options.sampled) {
    options.sampled.emplace();
  }
  const auto set = [](auto& value, const auto& wanted) {
    if (wanted) value = *wanted;
  };
  set(options.shadow.points, arguments.points);
  set(options.shadow.patches, arguments.patches);
  set(options.shadow.resolution, arguments.resolution);
  set(options.shadow.patch_resolution, arguments.patch_resolution);
  if (options.sampled) {
    set(options.sampled->rays, arguments.rays);
    set(options.patch_rays, arguments.patch_rays);
    options.sampled->seed = arguments.seed;
  } else if (arguments.rays || arguments.patch_rays) {
    throw std::invalid_argument("--rays and --patch-rays: the producer shadow casts none; take sandwich");
  }
  options.occluders.threads = arguments.threads;
  return options;
}

/// The same runner; each stage's name begins with the prefix, since a name may stand once in a run.
class Prefixed : public JobRunner {
 public:
  Prefixed(JobRunner& runner, std::string prefix) : runner_(runner), prefix_(std::move(prefix)) {}
  std::vector<Piece> run(const std::string& stage, std::uint64_t count,
                         const std::function<Piece(std::uint64_t)>& piece,
                         const Progress& progress) override {
    return runner_.run(prefix_ + stage, count, piece, progress);
  }
  bool leads() const override { return runner_.leads(); }

 private:
  JobRunner& runner_;
  std::string prefix_;
};

Stages show_stages(const JobRunner& runner) {
  if (!runner.leads()) return {};
  return [](const char* stage) { return show_progress(stage); };
}

/// For the octree: triangles of each cell's vLOD, over what one shadow view does not hide.
VisibleTriangles count_triangles(const Scene& scene, JobRunner& runner) {
  return [&, level = 0, lods = std::shared_ptr<LevelsOfDetail>()](const ViewCells& cells) mutable {
    if (!lods) {
      lods = std::make_shared<LevelsOfDetail>(
          scene, Screen{}, 0u, runner.leads() ? show_progress("simplifying objects") : Progress{});
    }
    Prefixed on_level(runner, "octree " + std::to_string(level++) + ", ");
    const Sight sight = see_bounds(scene, cells, effort(0), on_level, show_stages(runner));
    std::vector<std::uint64_t> triangles(cells.count());
    for (std::uint32_t cell = 0; cell < cells.count(); ++cell) {
      triangles[cell] = lods->visible_triangles(cells.boxes[cell], sight.not_hidden.row(cell));
    }
    return triangles;
  };
}

std::uint32_t checksum_of(const SceneFile& file) {
  const Scene& scene = file.scene;
  std::vector<std::uint32_t> parts;
  const auto add = [&](const auto& values) { parts.push_back(crc32(std::as_bytes(std::span(values)))); };
  add(scene.vertices), add(scene.indices), add(scene.object_of_triangle), add(scene.see_through);
  add(file.cells.corners), add(file.cells.boxes), add(std::array{file.cells.eye_low, file.cells.eye_high});
  return crc32(std::as_bytes(std::span(parts)));
}

struct Output {
  Dataset all;  // all but the matrix and how it was made
  const Arguments& arguments;

  void write(const std::string& path, VisibilityMatrix matrix, Guarantee guarantee, const std::string& made,
             std::span<const SightLine> lines = {}, std::span<const float> degree = {}) const {
    Dataset dataset = all;
    dataset.matrix = std::move(matrix);
    dataset.guarantee = guarantee;
    dataset.provenance = made + "; of " + all.provenance;
    for (const SightLine& line : lines) {
      dataset.sight_lines.push_back({line.from.x, line.from.y, line.from.z, line.to.x, line.to.y, line.to.z});
    }
    dataset.degree_of_visibility.assign(degree.begin(), degree.end());
    if (dataset.source.tree && !arguments.objects) dataset = over_nodes(dataset);
    write_dataset(path, dataset);
    const Shape shape = dataset.matrix.shape();
    std::printf("%s: %s view cells x %s %ss, %.2f %% visible, %s\n", path.c_str(),
                grouped(shape.rows).c_str(), grouped(shape.columns).c_str(), dataset.columns_are.c_str(),
                100 * dataset.matrix.density(), std::string(to_string(guarantee)).c_str());
  }
};

/// A line a state: how many objects of a cell, on average and at most.
void print_states(const Sight& sight, bool rays) {
  const Shape shape = sight.not_hidden.shape();
  std::uint64_t most_seen = 0, most_undecided = 0, least_hidden = shape.columns;
  for (std::uint32_t cell = 0; cell < shape.rows; ++cell) {
    const std::uint64_t seen = sight.seen.row(cell).size(), not_hidden = sight.not_hidden.row(cell).size();
    most_seen = std::max(most_seen, seen);
    most_undecided = std::max(most_undecided, not_hidden - seen);
    least_hidden = std::min(least_hidden, shape.columns - not_hidden);
  }
  const double rows = std::max(1u, shape.rows), columns = std::max(1u, shape.columns);
  const auto tell = [&](const char* state, double mean, const char* extreme, std::uint64_t worst) {
    std::printf("  %-10s %9.1f objects a cell, %6.2f %%; %s %s\n", state, mean, 100 * mean / columns, extreme,
                grouped(worst).c_str());
  };
  const double seen = static_cast<double>(sight.seen.ones()) / rows,
               not_hidden = static_cast<double>(sight.not_hidden.ones()) / rows;
  if (rays) tell("seen", seen, "at most", most_seen);
  tell("undecided", not_hidden - seen, "at most", most_undecided);
  tell("hidden", columns - not_hidden, "at least", least_hidden);
  if (rays) std::printf("  %s rays\n", grouped(sight.rays).c_str());
}

/// What rays that took no part in the search say of it.
void print_error(const AimedRays& rays, const ViewCells& cells, const Sight& sight, std::uint64_t seed,
                 JobRunner& runner) {
  constexpr std::uint32_t rays_a_cell = 1000;
  const auto held_back =
      held_back_error(rays, cells, sight.seen, rays_a_cell, seed, runner,
                      runner.leads() ? show_progress("checking by other rays") : Progress{});
  if (!runner.leads()) return;
  std::uint64_t all_rays = 0, missed_rays = 0, objects = 0, missed_objects = 0;
  for (const HeldBack& cell : held_back) {
    all_rays += cell.rays, missed_rays += cell.missed_rays;
    objects += cell.objects, missed_objects += cell.missed_objects;
  }
  std::printf(
      "  other rays: %.4f %% of the view shows what is not listed (below %.4f %% at 95 %% confidence), %.3f "
      "%% of the objects they meet are not\n",
      all_rays == 0 ? 0.0 : 100 * static_cast<double>(missed_rays) / static_cast<double>(all_rays),
      100 * missed_at_most(missed_rays, all_rays),
      objects == 0 ? 0.0 : 100 * static_cast<double>(missed_objects) / static_cast<double>(objects));
}

void run_climbing(const Arguments& arguments, const SceneFile& file, const Output& output) {
  RaySamplingOptions options = arguments.climbing;
  options.seed = arguments.seed;
  options.threads = arguments.threads;
  SeenByRays seen = see_by_rays(file.scene, file.cells, options, show_progress("looking around"));
  std::uint64_t late = 0;
  for (const std::uint32_t yield : seen.last_yield) late += yield;
  const auto ones = static_cast<double>(std::max<std::uint64_t>(1, seen.objects.ones()));
  output.write(arguments.output, std::move(seen.objects), Guarantee::aggressive, describe(options));
  std::printf("  %s rays, the last pass found %.2f %%\n", grouped(seen.rays).c_str(),
              100 * static_cast<double>(late) / ones);
}

void run(const Arguments& arguments) {
  const auto runner = make_job_runner(arguments.threads);
  const CellsChoice choice = parse_cells(arguments.cells);
  const bool climbing = arguments.producer == "climbing", sampling = arguments.producer == "sampled";
  const BoundsOptions options = bounds_options(arguments);
  if (!arguments.seen.empty() && !options.sampled) {
    throw std::invalid_argument("--seen: the producer shadow proves nothing seen; take sandwich");
  }
  if (!arguments.seen.empty() && (sampling || climbing)) {
    throw std::invalid_argument("--seen: all that this producer writes is seen; -o has it");
  }
  SceneFile file = read_any_scene(arguments.scene).file;
  if (arguments.nodes && !file.tree) {
    throw std::invalid_argument(arguments.scene + ": has no tree, so --nodes cannot be; use --objects");
  }
  const std::string made = sampling   ? describe(*options.sampled)
                           : climbing ? describe(arguments.climbing)
                                      : describe(options);
  const std::string chosen = describe(choice);
  const auto journal =
      climbing
          ? nullptr
          : keep_journal(*runner, arguments.output,
                         "see, scene " + std::to_string(checksum_of(file)) + "; " + chosen + "; " + made);
  ChosenCells cells = choose_cells(file.scene, file.cells, choice, count_triangles(file.scene, *runner));
  file.cells = std::move(cells.cells);
  if (runner->leads()) std::fputs(cells.table.c_str(), stdout);

  Output output{{}, arguments};
  output.all.provenance =
      (std::holds_alternative<std::monostate>(choice) ? "" : chosen + "; ") + file.provenance;
  output.all.seed = arguments.seed;
  output.all.row_bounds = cell_bounds(file.cells);
  output.all.column_bounds = object_bounds(file.scene);
  output.all.row_neighbours = file.cells.neighbours;
  output.all.source.tree = std::move(file.tree);

  if (climbing) {
    if (runner->leads()) run_climbing(arguments, file, output);
  } else if (sampling) {
    const RayCaster caster(file.scene);
    const AimedRays rays(file.scene, caster);
    const Sight sight = see_by_sampling(rays, file.cells, *options.sampled, *runner,
                                        runner->leads() ? show_progress("looking around") : Progress{});
    if (runner->leads()) {
      output.write(arguments.output, sight.seen, Guarantee::aggressive, made, sight.lines, sight.degree);
      std::printf("  %s rays\n", grouped(sight.rays).c_str());
    }
    print_error(rays, file.cells, sight, arguments.seed, *runner);
  } else {
    const Sight sight = see_bounds(file.scene, file.cells, options, *runner, show_stages(*runner));
    if (runner->leads()) {
      output.write(arguments.output, sight.not_hidden, Guarantee::conservative, made);
      if (!arguments.seen.empty()) {
        output.write(arguments.seen, sight.seen, Guarantee::aggressive, made, sight.lines, sight.degree);
      }
      print_states(sight, options.sampled.has_value());
    }
  }
  if (journal) journal->remove();
}

}  // namespace

void add_see(Program& program) {
  const auto arguments = std::make_shared<Arguments>();
  Arguments& a = *arguments;
  const Verb verb = program.verb("see", "Find which objects are visible from each view cell of a scene");
  verb.option("SCENE", a.scene, "A scene file, a mesh (.obj, .ply, .off, .stl) or a Quake 3 level")
      .required();
  verb.output(a.output, "The matrix file to write (.bsp.h5 or .mtx)");
  verb.option("--seen", a.seen,
              "Also write the matrix of what is proven to be seen, with its sight lines (sandwich)");
  verb.option("--producer", a.producer,
              "How: by shadows, by sampled rays, or by both (sandwich); climbing is for cities of boxes")
      .one_of({"shadow", "sampled", "sandwich", "climbing"});
  add_cells_options(verb, a.cells);
  verb.option("--effort", a.effort,
              "0: shadows of the whole view cell; 1: also rays, and some patches of the cell's boundary; 2: "
              "many patches")
      .between(0, 2);
  verb.option("--points", a.points, "Number of projection points of a view cell: 1, 9 or 27 (by effort)");
  verb.option("--patches", a.patches,
              "Greatest number of patches of a view cell's boundary to look from (by effort)");
  verb.option("--resolution", a.resolution, "Pixels along a side of each of a view's six faces (by effort)");
  verb.option("--patch-resolution", a.patch_resolution, "The same for patches (by effort)");
  verb.option("--rays", a.rays,
              "Greatest number of aimed rays for each view cell and round (sampled, sandwich)");
  verb.option("--patch-rays", a.patch_rays, "Number of rays for each patch (sandwich)");
  verb.option("--directions", a.climbing.directions,
              "Climbing: number of unaimed directions around each viewpoint in the first pass");
  verb.option("--viewpoints", a.climbing.origins,
              "Climbing: number of viewpoints on each edge of a view cell in each pass");
  verb.option("--passes", a.climbing.passes, "Climbing: greatest number of passes");
  verb.option("--enough", a.climbing.enough_yield,
              "Climbing: a view cell is done when a pass adds less than this share of what it sees");
  verb.option("--seed", a.seed, "Another seed casts other rays");
  verb.threads(a.threads);
  const Option nodes =
      verb.flag("--nodes", a.nodes, "Each column is a node of the scene's tree (the default if it has one)");
  verb.flag("--objects", a.objects, "Each column is an object").excludes(nodes);
  verb.note(
      "shadow lists all that is visible, and perhaps more. sampled and climbing list only what is visible, "
      "and perhaps not all of it. sandwich gives both: -o has what is not proven to be hidden, --seen what "
      "is proven to be seen.\n"
      "A run that was killed continues where it was; 'mpirun -n K vismat see ...' shares the work.");
  verb.example(
      "vismat see station.obj --cells grid:4 --eyes 1.5,1.8 -o station.bsp.h5 --seen station.seen.bsp.h5");
  verb.runs([arguments] { run(*arguments); });
}

}  // namespace vismat::cli
