// vismat dense-city: a made-up city in fine triangles as a scene file.
#include "visibility/generators/dense_city.h"

#include <cstdio>
#include <memory>

#include "cli/verbs.h"

namespace vismat::cli {
namespace {

struct Arguments {
  DenseCityOptions options;
  std::string output;
};

void run(const Arguments& arguments) {
  const SceneFile city = make_dense_city(arguments.options);
  write_scene(arguments.output, city);
  std::printf("%s: %zu triangles in %u objects, %u view cells\n", arguments.output.c_str(),
              city.scene.object_of_triangle.size(), city.scene.object_count, city.cells.count());
}

}  // namespace

void add_dense_city(CLI::App& app) {
  auto arguments = std::make_shared<Arguments>();
  DenseCityOptions& o = arguments->options;
  CLI::App* verb = app.add_subcommand(
      "dense-city",
      "Make a city of a million triangles: buildings, rooms, cars, and view cells on the streets");
  verb->footer("Example: vismat dense-city --size 8 -o dense8.scene.h5 && vismat info dense8.scene.h5");
  const auto add = [&](const char* name, auto& value, const char* help) {
    verb->add_option(name, value, help)->capture_default_str();
  };
  add("--size", o.size, "Squares a side, with a building or cars on each");
  add("--pitch", o.pitch, "Side of a square, metres");
  add("--street", o.street, "Width of the strip that stays free between squares, metres");
  add("--smallest-side", o.smallest_side, "Of a building, metres");
  add("--largest-side", o.largest_side, "Of a building, metres");
  add("--lowest", o.lowest, "Height of the lowest building, metres");
  add("--highest", o.highest, "Height of the highest building, metres");
  add("--step", o.step, "Longest leg of a wall's triangle, metres");
  add("--interiors", o.interiors, "Share of the buildings with rooms and furniture");
  add("--car-parks", o.car_parks, "Share of the squares with cars instead of a building");
  add("--car-sides", o.car_sides, "Points round a car's body; twice their square is its triangles");
  add("--cell", o.cell, "Side of a view cell, metres");
  add("--eye-low", o.eye_low, "Least height of the viewer's eyes, metres");
  add("--eye-high", o.eye_high, "Greatest height of the viewer's eyes, metres");
  add("--seed", o.seed, "Another seed, another city");
  verb->add_option("-o,--output", arguments->output, "The scene file to write (.scene.h5)")->required();
  verb->callback([arguments] { run(*arguments); });
}

}  // namespace vismat::cli
