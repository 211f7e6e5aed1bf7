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
#include "matrix/files/dataset_file.h"
#include "programs/jobs.h"
#include "programs/options.h"
#include "programs/progress.h"
#include "visibility/detail/levels_of_detail.h"
#include "visibility/meshes/any_scene.h"
#include "visibility/producers/bounds.h"
#include "visibility/producers/producers.h"
#include "visibility/producers/see_levels.h"
#include "visibility/rays/sampled.h"

namespace vismat::cli {
namespace {

struct SeeArguments {
  std::string scene, output, seen, producer = "sandwich";
  CellsWords cells;
  ProducerOptions options;
  bool nodes = false, objects = false, levels = false;
  Screen screen;
};

/// Throws std::invalid_argument if the producer has no use for an option that is given.
void check_options(const SeeArguments& arguments, const Producer& producer) {
  check_taken(producer, arguments.options);
  if (arguments.levels) {
    pixels_per_radian(arguments.screen);  // throws
    if (producer.see_levels == nullptr) {
      std::string able;
      for (const Producer& other : producers()) {
        if (other.see_levels != nullptr) able += (able.empty() ? "" : ", ") + std::string(other.name);
      }
      throw std::invalid_argument("--levels: the producer " + std::string(producer.name) +
                                  " cannot; these can: " + able);
    }
  }
  if (arguments.seen.empty() || producer.seen_too) return;
  const std::string name(producer.name);
  if (producer.guarantee == Guarantee::aggressive) {
    throw std::invalid_argument("--seen: all that the producer " + name + " lists is seen; -o has it");
  }
  throw std::invalid_argument("--seen: the producer " + name + " proves nothing seen");
}

/// The same runner, which puts the prefix before each stage's name, since a name may be used only once in a run.
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

/// The levels of detail of a scene, which are made when they are first asked for.
class Levels {
 public:
  Levels(const Scene& scene, const Screen& screen, unsigned threads, const JobRunner& runner)
      : scene_(scene), screen_(screen), threads_(threads), leads_(runner.leads()) {}
  const LevelsOfDetail& operator()() {
    if (!levels_) {
      levels_.emplace(scene_, screen_, threads_, leads_ ? show_progress("simplifying objects") : Progress{});
    }
    return *levels_;
  }

 private:
  const Scene& scene_;
  Screen screen_;
  unsigned threads_;
  bool leads_;
  std::optional<LevelsOfDetail> levels_;
};

/// For the octree: the number of triangles that are drawn from each cell, at levels of detail, of what one shadow view
/// does not hide: of the scene, or, with --levels, of the scene at the cell's levels. Keeps references.
VisibleTriangles count_triangles(const Scene& scene, Levels& levels, bool see_at_levels, JobRunner& runner) {
  return [&, see_at_levels, level = 0](const ViewCells& cells) mutable {
    Prefixed on_level(runner, "octree " + std::to_string(level++) + ", ");
    std::vector<std::uint64_t> triangles(cells.count());
    if (see_at_levels) {
      const LevelSight seen = see_levels(scene, levels(), cells, effort(0), on_level, show_stages(runner));
      for (std::uint32_t cell = 0; cell < cells.count(); ++cell) {
        for (const std::uint32_t column : seen.sight.not_hidden.row(cell)) {
          const auto [object, at] = seen.columns[column];
          triangles[cell] += levels().facing_triangles(cells.boxes[cell], object, at);
        }
      }
      return triangles;
    }
    const LevelsOfDetail& drawn = levels();
    const Sight sight = see_bounds(scene, cells, effort(0), on_level, show_stages(runner));
    for (std::uint32_t cell = 0; cell < cells.count(); ++cell) {
      triangles[cell] = drawn.visible_triangles(cells.boxes[cell], sight.not_hidden.row(cell));
    }
    return triangles;
  };
}

/// The name of each column, if the scene's objects have names.
std::vector<std::string> names_of(std::span<const ObjectLevel> columns,
                                  std::span<const std::string> objects) {
  std::vector<std::string> names;
  if (objects.empty()) return names;
  for (const auto& [object, level] : columns)
    names.push_back(objects[object] + ", level " + std::to_string(level));
  return names;
}

struct Output {
  Dataset all;  // all but the matrix
  const SeeArguments& arguments;
  bool opacity_unknown = false;

  void write(const std::string& path, const VisibilityMatrix& matrix, Guarantee guarantee,
             const Sight& sight) const {
    Dataset dataset = all;
    dataset.matrix = matrix;
    dataset.guarantee = guarantee;
    if (&matrix == &sight.seen) {
      for (const SightLine& line : sight.lines) {
        dataset.sight_lines.push_back(
            {line.from.x, line.from.y, line.from.z, line.to.x, line.to.y, line.to.z});
      }
      dataset.degree_of_visibility = sight.degree;
    }
    if (dataset.source.tree && !arguments.objects) dataset = over_nodes(dataset);
    write_dataset(path, dataset);
    const Shape shape = dataset.matrix.shape();
    std::printf("%s: %s view cells x %s %s, %.2f %% visible, %s%s\n", path.c_str(),
                grouped(shape.rows).c_str(), grouped(shape.columns).c_str(),
                plural_of(dataset.columns_are).c_str(), 100 * dataset.matrix.density(),
                std::string(to_string(guarantee)).c_str(),
                opacity_unknown && guarantee != Guarantee::aggressive ? " if every surface is opaque" : "");
  }
};

/// One line for each state: how many of `objects` objects of a cell are in it, on average and at most.
void print_states(const Sight& sight, std::uint32_t objects, bool proves_seen) {
  const Shape shape{sight.not_hidden.shape().rows, objects};
  std::uint64_t most_seen = 0, most_undecided = 0, least_hidden = shape.columns;
  for (std::uint32_t cell = 0; cell < shape.rows; ++cell) {
    const std::uint64_t seen = proves_seen ? sight.seen.row(cell).size() : 0,
                        not_hidden = sight.not_hidden.row(cell).size();
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
  if (proves_seen) tell("seen", seen, "at most", most_seen);
  tell("undecided", not_hidden - seen, "at most", most_undecided);
  tell("hidden", columns - not_hidden, "at least", least_hidden);
  if (proves_seen) std::printf("  %s rays\n", grouped(sight.rays).c_str());
}

/// How many rays were cast, and how much they say is missed.
void print_search(const Sight& sight) {
  std::printf("  %s rays", grouped(sight.rays).c_str());
  if (sight.last_found) {
    std::printf(", the last pass found %.2f %%",
                100 * static_cast<double>(*sight.last_found) /
                    static_cast<double>(std::max<std::uint64_t>(1, sight.seen.ones())));
  }
  std::printf("\n");
  if (!sight.held_back) return;
  const auto [rays, missed_rays, objects, missed_objects] = *sight.held_back;
  std::printf(
      "  other rays: %.4f %% of the view shows what is not listed (below %.4f %% at 95 %% confidence), %.3f "
      "%% of the objects they meet are not\n",
      rays == 0 ? 0.0 : 100 * static_cast<double>(missed_rays) / static_cast<double>(rays),
      100 * missed_at_most(missed_rays, rays),
      objects == 0 ? 0.0 : 100 * static_cast<double>(missed_objects) / static_cast<double>(objects));
}

void run_see(const SeeArguments& arguments) {
  const auto runner = make_job_runner(arguments.options.threads);
  const Producer& producer = producer_named(arguments.producer);
  check_options(arguments, producer);
  parse_cells(arguments.cells);  // refuses what cannot be before the scene is read
  AnyScene read = read_any_scene(arguments.scene);
  SceneFile& file = read.file;
  const CellsChoice choice = parse_cells(arguments.cells, file.origin);
  const std::string made = arguments.levels ? producer.describe_levels(arguments.options, arguments.screen)
                                            : producer.describe(arguments.options),
                    chosen = describe(choice);
  if (arguments.nodes && !file.tree) {
    throw std::invalid_argument(arguments.scene + ": has no tree, so --nodes cannot be; use --objects");
  }
  const std::string work = "see, scene " + std::to_string(checksum_of(file)) + "; " + chosen + "; " + made;
  std::unique_ptr<Journal> journal;
  // Cells that are refused leave no journal; those of an octree are counted in pieces that it keeps.
  const bool counted = std::holds_alternative<OctreeCellsOptions>(choice);
  if (counted) journal = keep_journal(*runner, arguments.output, work);
  Levels levels(file.scene, arguments.levels ? arguments.screen : Screen{}, arguments.options.threads,
                *runner);
  ChosenCells cells = choose_cells(file.scene, file.cells, choice,
                                   count_triangles(file.scene, levels, arguments.levels, *runner));
  if (!counted) journal = keep_journal(*runner, arguments.output, work);
  file.cells = std::move(cells.cells);
  if (runner->leads()) std::fputs(cells.table.c_str(), stdout);

  const auto see = [&] {
    try {
      if (arguments.levels) {
        return producer.see_levels(file.scene, levels(), file.cells, arguments.options, *runner,
                                   show_stages(*runner));
      }
      return LevelSight{
          {}, {}, producer.see(file.scene, file.cells, arguments.options, *runner, show_stages(*runner))};
    } catch (const std::invalid_argument&) {  // an option that the first piece of work refuses
      if (journal && journal->empty()) journal->remove();
      throw;
    }
  };
  LevelSight at_levels = see();
  if (!runner->leads()) return;
  const Sight& sight = at_levels.sight;
  Output output{{}, arguments};
  output.all.provenance = made + "; of " +
                          (std::holds_alternative<std::monostate>(choice) ? "" : chosen + "; ") +
                          file.provenance;
  output.all.seed = arguments.options.seed.value_or(1);
  output.all.row_bounds = cell_bounds(file.cells);
  output.all.row_neighbours = file.cells.neighbours;
  if (arguments.levels) {
    output.all.columns_are = "object at a level of detail";
    output.all.column_bounds = std::move(at_levels.column_bounds);
    output.all.source.column_names = names_of(at_levels.columns, file.scene.object_names);
    output.all.source.column_levels = std::move(at_levels.columns);
  } else {
    output.all.column_bounds = object_bounds(file.scene);
    output.all.source.tree = std::move(file.tree);
    output.all.source.column_names = file.scene.object_names;
  }
  output.opacity_unknown = file.opacity_unknown;
  output.write(arguments.output, producer.listed(sight), producer.guarantee, sight);
  if (!arguments.seen.empty()) output.write(arguments.seen, sight.seen, Guarantee::aggressive, sight);
  if (producer.guarantee == Guarantee::aggressive) {
    print_search(sight);
  } else {
    print_states(sight, file.scene.object_count, producer.seen_too);
  }
  print_notes(read);
  journal->remove();
}

/// Adds --producer, and an option for everything that producers take.
void add_producers(const Verb& verb, SeeArguments& arguments) {
  std::vector<std::string> names;
  for (const Producer& producer : producers()) names.emplace_back(producer.name);
  verb.option("--producer", arguments.producer, "Method; see below").one_of(names);
  for (const ProducerOption& option : producer_options()) {
    const std::string help = std::string(option.help) + " (" + takers_of(option) + "; default " +
                             (option.by_default.empty() ? "by effort" : std::string(option.by_default)) + ")";
    std::visit(
        [&](auto member) { verb.option("--" + std::string(option.name), arguments.options.*member, help); },
        option.setting);
  }
}

/// One line for each producer.
std::string ideas() {
  std::string text;
  for (const Producer& producer : producers()) {
    const bool aggressive = producer.guarantee == Guarantee::aggressive;
    text += std::string(producer.name) + ": " + std::string(producer.idea) + ". " +
            (aggressive ? "All that is listed is visible" : "What is listed includes all that is visible") +
            (producer.seen_too ? "; --seen has what is visible for sure" : "") + ".\n";
  }
  return text;
}

/// The options of the picture for which levels of detail are chosen.
void add_screen(const Verb& verb, Screen& screen, const Option& levels) {
  verb.option("--width", screen.width, "Width of the picture in pixels").needs(levels);
  verb.option("--height", screen.height, "Height of the picture in pixels").needs(levels);
  verb.option("--field-of-view", screen.field_of_view, "Horizontal field of view in degrees").needs(levels);
}

}  // namespace

void add_see(Program& program) {
  const auto arguments = std::make_shared<SeeArguments>();
  SeeArguments& a = *arguments;
  const Verb verb = program.verb("see", "Find which objects are visible from each view cell of a scene");
  verb.input("SCENE", a.scene, "A scene file, a mesh (.obj, .ply, .off, .stl) or a Quake 3 level").required();
  verb.output(a.output, Written::matrix, "The matrix file to write (.bsp.h5, .mtx, .npy or .npz)");
  verb.output("--seen", a.seen, Written::matrix,
              "Also write the matrix of what is proven to be seen, with its sight lines");
  add_cells_options(verb, a.cells);
  add_producers(verb, a);
  verb.threads(a.options.threads);
  const Option nodes =
      verb.flag("--nodes", a.nodes, "Each column is a node of the scene's tree (the default if it has one)");
  verb.flag("--objects", a.objects, "Each column is an object").excludes(nodes);
  const Option levels =
      verb.flag(
              "--levels", a.levels,
              "Each column is an object at a level of detail. Each view cell's levels are the coarsest that "
              "deviate by less than a pixel, and it sees the scene at these levels (shadow, sandwich)")
          .excludes(nodes);
  add_screen(verb, a.screen, levels);
  verb.note(ideas() +
            "A run that was killed continues where it was; 'mpirun -n K vismat see ...' shares the work.");
  verb.example(
      "vismat see station.obj --cells grid:4 --eyes 1.5,1.8 -o station.bsp.h5 --seen station.seen.bsp.h5");
  verb.example("vismat see city.scene.h5 --levels --width 1280 --height 1024 -o city.levels.bsp.h5");
  verb.runs([arguments] { run_see(*arguments); });
}

}  // namespace vismat::cli
