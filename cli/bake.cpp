// vismat bake: makes all that a walk through a scene needs.
#include "programs/bake.h"

#include <cstdio>
#include <memory>
#include <stdexcept>
#include <variant>

#include "cli/cells_options.h"
#include "cli/summary.h"
#include "cli/verbs.h"
#include "programs/jobs.h"
#include "programs/options.h"
#include "programs/progress.h"
#include "runtime/walks/baked_scene.h"
#include "visibility/meshes/any_scene.h"

namespace vismat::cli {
namespace {

struct BakeArguments {
  std::string scene;
  CellsWords cells;
  BakeOptions options;
};

void run_bake(BakeArguments arguments) {
  const auto runner = make_job_runner(arguments.options.visibility.threads);
  const Producer& producer = producer_named(arguments.options.producer);
  check_taken(producer, arguments.options.visibility);
  parse_cells(arguments.cells);  // refuses what cannot be before the scene is read
  AnyScene read = read_any_scene(arguments.scene);
  const CellsChoice choice = parse_cells(arguments.cells, read.file.origin);
  if (std::holds_alternative<OctreeCellsOptions>(choice)) {
    throw std::invalid_argument(
        "--cells: make the cells of an octree with 'vismat cells' and bake that scene");
  }
  read.file.cells = choose_cells(read.file.scene, read.file.cells, choice, {}).cells;
  if (runner->leads()) arguments.options.stages = show_progress;

  std::filesystem::create_directories(arguments.options.folder);
  const auto journal = keep_journal(*runner, (arguments.options.folder / baked::matrix).string(),
                                    "bake, scene " + std::to_string(checksum_of(read.file)) + "; " +
                                        describe(read.file, arguments.options));
  const std::vector<BakedPart> parts = bake(read.file, arguments.options, *runner);
  if (!runner->leads()) return;
  journal->remove();
  double seconds = 0;
  std::uint64_t bytes = 0;
  std::printf("%-20s %10s %14s\n", "part", "seconds", "bytes");
  for (const BakedPart& part : parts) {
    std::printf("%-20s %10.2f %14s\n", part.name.c_str(), part.seconds,
                part.bytes == 0 ? "" : grouped(part.bytes).c_str());
    seconds += part.seconds, bytes += part.bytes;
  }
  std::printf("%-20s %10.2f %14s\n", "all", seconds, grouped(bytes).c_str());
  print_notes(read);
}

}  // namespace

void add_bake(Program& program) {
  const auto arguments = std::make_shared<BakeArguments>();
  BakeArguments& a = *arguments;
  const Verb verb = program.verb(
      "bake", "Make all that a walk through a scene needs: levels of detail, visibility, lists, geometry");
  verb.input("SCENE", a.scene, "A scene file, a mesh (.obj, .ply, .off, .stl) or a Quake 3 level").required();
  verb.output(a.options.folder, Written::made_folder, "The folder to write; it is made if it is not there");
  add_cells_options(verb, a.cells);
  verb.option("--producer", a.options.producer,
              "Method that finds what is visible, see 'vismat see --levels'");
  verb.option("--effort", a.options.visibility.effort, "0 to 2: time for accuracy");
  verb.option("--codec", a.options.codec, "Codec of rows and lists; one that decodes single rows");
  verb.option("--width", a.options.screen.width,
              "Width in pixels of the picture for which levels are chosen");
  verb.option("--height", a.options.screen.height, "Height of that picture in pixels");
  verb.option("--field-of-view", a.options.screen.field_of_view, "Its horizontal field of view in degrees");
  verb.threads(a.options.visibility.threads);
  verb.note("A bake that was stopped continues where it was, and gives the same bytes.");
  verb.example("vismat bake dense8.scene.h5 -o dense8.bake && vismat walk dense8.bake dense8.path");
  verb.runs([arguments] { run_bake(*arguments); });
}

}  // namespace vismat::cli
