// vismat plant: a made-up chemical plant as a scene file.
#include "visibility/generators/plant.h"

#include <cstdio>
#include <memory>

#include "cli/verbs.h"

namespace vismat::cli {
namespace {

struct Arguments {
  PlantOptions options;
  unsigned threads = 0;
  std::string output;
};

void run(const Arguments& arguments) {
  const SceneFile plant = make_plant(arguments.options, arguments.threads);
  write_scene(arguments.output, plant);
  std::printf("%s: %zu triangles in %u objects, %u view cells\n", arguments.output.c_str(),
              plant.scene.object_of_triangle.size(), plant.scene.object_count, plant.cells.count());
}

}  // namespace

void add_plant(CLI::App& app) {
  auto arguments = std::make_shared<Arguments>();
  PlantOptions& o = arguments->options;
  CLI::App* verb = app.add_subcommand(
      "plant",
      "Make a plant of pipes and tanks, tens of thousands of components, and view cells all over it");
  verb->footer("Example: vismat plant --size 4 -o plant4.scene.h5 && vismat info plant4.scene.h5");
  const auto add = [&](const char* name, auto& value, const char* help) {
    verb->add_option(name, value, help)->capture_default_str();
  };
  add("--size", o.size, "Bays a side, with a tank, vessels or a steel frame in each");
  add("--bay", o.bay, "Side of a bay, metres");
  add("--height", o.height, "Of the space that pipes run through, metres");
  add("--pipes", o.pipes, "Share of that space that pipes take at most");
  add("--pipe-sides", o.pipe_sides, "Points round a pipe");
  add("--cell", o.cell, "Side of a view cell, metres");
  add("--seed", o.seed, "Another seed, another plant");
  add("--threads", arguments->threads, "0: one a core; the bytes are the same for any number");
  verb->add_option("-o,--output", arguments->output, "The scene file to write (.scene.h5)")->required();
  verb->callback([arguments] { run(*arguments); });
}

}  // namespace vismat::cli
