// vismat city: a made-up city as a scene file.
#include "visibility/generators/city.h"

#include <cstdio>
#include <memory>

#include "cli/verbs.h"

namespace vismat::cli {
namespace {

struct Arguments {
  CityOptions options;
  std::string output;
};

void run(const Arguments& arguments) {
  const SceneFile city = make_city(arguments.options);
  write_scene(arguments.output, city);
  std::printf("%s: %u boxes, %u tree nodes, %u view cells\n", arguments.output.c_str(),
              city.scene.object_count, city.tree->size(), city.cells.count());
}

}  // namespace

void add_city(CLI::App& app) {
  auto arguments = std::make_shared<Arguments>();
  CityOptions& o = arguments->options;
  CLI::App* verb =
      app.add_subcommand("city", "Make a city of boxes: objects, their quadtree, and view cells");
  verb->footer(
      "The defaults are 'artificial 1' of Zach & Karner 2003; with --size 64, 'artificial 2'.\n"
      "Example: vismat city --size 32 -o city32.scene.h5 && vismat see city32.scene.h5 --producer climbing "
      "-o city32.bsp.h5");
  const auto add = [&](const char* name, auto& value, const char* help) {
    verb->add_option(name, value, help)->capture_default_str();
  };
  add("--size", o.size, "Boxes a side, a power of two");
  add("--pitch", o.pitch, "Side of the square in which each box stands, metres");
  add("--street", o.narrowest_street, "Least distance of two boxes, metres");
  add("--smallest-side", o.smallest_side, "Of a box, metres");
  add("--largest-side", o.largest_side, "Of a box, metres");
  add("--lowest", o.lowest, "Height of the lowest box, metres");
  add("--highest", o.highest, "Height of the highest box, metres");
  add("--jitter", o.jitter, "0: each box in the middle of its square; 1: anywhere in it");
  add("--eye-low", o.eye_low, "Least height of the viewer's eyes, metres");
  add("--eye-high", o.eye_high, "Greatest height of the viewer's eyes, metres");
  add("--seed", o.seed, "Another seed, another city");
  verb->add_option("-o,--output", arguments->output, "The scene file to write (.scene.h5)")->required();
  verb->callback([arguments] { run(*arguments); });
}

}  // namespace vismat::cli
