// vismat city: makes a city of boxes as a scene file.
#include "visibility/generators/city.h"

#include <cstdio>
#include <memory>

#include "cli/verbs.h"
#include "programs/options.h"

namespace vismat::cli {
namespace {

struct CityArguments {
  CityOptions options;
  std::string output;
};

void run_city(const CityArguments& arguments) {
  const SceneFile city = make_city(arguments.options);
  write_scene(arguments.output, city);
  std::printf("%s: %u boxes, %u tree nodes, %u view cells\n", arguments.output.c_str(),
              city.scene.object_count, city.tree->size(), city.cells.count());
}

}  // namespace

void add_city(Program& program) {
  const auto arguments = std::make_shared<CityArguments>();
  CityOptions& o = arguments->options;
  const Verb verb =
      program.verb("city", "Make a city of boxes: a scene file with objects, their quadtree and view cells");
  verb.option("--size", o.size, "Number of boxes along each side of the city, a power of two");
  verb.option("--pitch", o.pitch, "Side of the square in which each box stands, in metres");
  verb.option("--street", o.narrowest_street, "Least distance between two boxes, in metres");
  verb.option("--smallest-side", o.smallest_side, "Shortest side of a box, in metres");
  verb.option("--largest-side", o.largest_side, "Longest side of a box, in metres");
  verb.option("--lowest", o.lowest, "Height of the lowest box, in metres");
  verb.option("--highest", o.highest, "Height of the highest box, in metres");
  verb.option("--jitter", o.jitter, "0: each box stands in the middle of its square; 1: anywhere in it");
  verb.option("--eye-low", o.eye_low, "Least height of the viewer's eyes, in metres");
  verb.option("--eye-high", o.eye_high, "Greatest height of the viewer's eyes, in metres");
  verb.option("--seed", o.seed, "Another seed makes another city");
  verb.output(arguments->output, Written::scene, "The scene file to write (.scene.h5)");
  verb.note(
      "The defaults make 'artificial 1' of Zach & Karner 2003; with --size 64 they make 'artificial 2'.");
  verb.example(
      "vismat city --size 32 -o city32.scene.h5 && vismat see city32.scene.h5 --producer climbing -o "
      "city32.bsp.h5");
  verb.runs([arguments] { run_city(*arguments); });
}

}  // namespace vismat::cli
