// vismat dense-city: makes a city of small triangles as a scene file.
#include "visibility/generators/dense_city.h"

#include <cstdio>
#include <memory>

#include "cli/verbs.h"
#include "programs/options.h"

namespace vismat::cli {
namespace {

struct DenseCityArguments {
  DenseCityOptions options;
  std::string output;
};

void run_dense_city(const DenseCityArguments& arguments) {
  const SceneFile city = make_dense_city(arguments.options);
  write_scene(arguments.output, city);
  std::printf("%s: %zu triangles in %u objects, %u view cells\n", arguments.output.c_str(),
              city.scene.object_of_triangle.size(), city.scene.object_count, city.cells.count());
}

}  // namespace

void add_dense_city(Program& program) {
  const auto arguments = std::make_shared<DenseCityArguments>();
  DenseCityOptions& o = arguments->options;
  const Verb verb = program.verb(
      "dense-city",
      "Make a city of a million triangles: buildings, rooms, cars, and view cells on the streets");
  verb.option("--size", o.size, "Number of squares along each side of the city; each has a building or cars");
  verb.option("--pitch", o.pitch, "Side of a square, in metres");
  verb.option("--street", o.street, "Width of the strip that stays free between squares, in metres");
  verb.option("--smallest-side", o.smallest_side, "Shortest side of a building, in metres");
  verb.option("--largest-side", o.largest_side, "Longest side of a building, in metres");
  verb.option("--lowest", o.lowest, "Height of the lowest building, in metres");
  verb.option("--highest", o.highest, "Height of the highest building, in metres");
  verb.option("--step", o.step, "Longest leg of a triangle of a wall, in metres");
  verb.option("--interiors", o.interiors, "Share of the buildings that have rooms and furniture");
  verb.option("--car-parks", o.car_parks, "Share of the squares that have cars instead of a building");
  verb.option(
      "--car-sides", o.car_sides,
      "Number of points around a car's body, which has about twice the square of this number of triangles");
  verb.option("--cell", o.cell, "Side of a view cell, in metres");
  verb.option("--eye-low", o.eye_low, "Least height of the viewer's eyes, in metres");
  verb.option("--eye-high", o.eye_high, "Greatest height of the viewer's eyes, in metres");
  verb.option("--seed", o.seed, "Another seed makes another city");
  verb.output(arguments->output, Written::scene, "The scene file to write (.scene.h5)");
  verb.example("vismat dense-city --size 8 -o dense8.scene.h5 && vismat info dense8.scene.h5");
  verb.runs([arguments] { run_dense_city(*arguments); });
}

}  // namespace vismat::cli
