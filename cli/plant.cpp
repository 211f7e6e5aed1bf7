// vismat plant: makes a chemical plant as a scene file.
#include "visibility/generators/plant.h"

#include <cstdio>
#include <memory>

#include "cli/verbs.h"
#include "programs/options.h"

namespace vismat::cli {
namespace {

struct PlantArguments {
  PlantOptions options;
  unsigned threads = 0;
  std::string output;
};

void run_plant(const PlantArguments& arguments) {
  const SceneFile plant = make_plant(arguments.options, arguments.threads);
  write_scene(arguments.output, plant);
  std::printf("%s: %zu triangles in %u objects, %u view cells\n", arguments.output.c_str(),
              plant.scene.object_of_triangle.size(), plant.scene.object_count, plant.cells.count());
}

}  // namespace

void add_plant(Program& program) {
  const auto arguments = std::make_shared<PlantArguments>();
  PlantOptions& o = arguments->options;
  const Verb verb = program.verb(
      "plant", "Make a chemical plant of tens of thousands of pipes and tanks, with view cells all over it");
  verb.option("--size", o.size,
              "Number of bays along each side of the plant; each has a tank, vessels or a steel frame");
  verb.option("--bay", o.bay, "Side of a bay, in metres");
  verb.option("--height", o.height, "Height of the space that pipes run through, in metres");
  verb.option("--pipes", o.pipes, "Greatest share of that space that pipes take");
  verb.option("--pipe-sides", o.pipe_sides, "Number of points around a pipe");
  verb.option("--cell", o.cell, "Side of a view cell, in metres");
  verb.option("--seed", o.seed, "Another seed makes another plant");
  verb.threads(arguments->threads);
  verb.output(arguments->output, Written::scene, "The scene file to write (.scene.h5)");
  verb.example("vismat plant --size 4 -o plant4.scene.h5 && vismat info plant4.scene.h5");
  verb.runs([arguments] { run_plant(*arguments); });
}

}  // namespace vismat::cli
