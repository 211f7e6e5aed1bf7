// generate: synthetic matrices in the likeness of the papers' large scenes.
#include "matrix/generate.h"

#include <cstdio>
#include <memory>
#include <sstream>
#include <string>

#include "cli/verbs.h"
#include "matrix/files/dataset_file.h"

namespace vismat::cli {
namespace {

struct Arguments {
  std::string scene, output;
  double scale = 1. / 64;
  bool harder = false;
  std::uint64_t seed = 1;
};

void run(const Arguments& arguments) {
  DeltaSceneOptions scene = arguments.scene == "city" ? city_scene(arguments.scale, arguments.harder)
                                                      : power_plant_scene(arguments.scale, arguments.harder);
  scene.seed = arguments.seed;
  Dataset data;
  data.matrix = generate_delta_scene(scene);
  data.rows_are = "boundary between view cells";
  std::ostringstream provenance;
  provenance << "vismat generate " << arguments.scene << " --scale " << arguments.scale
             << (arguments.harder ? " --harder" : "");
  data.provenance = provenance.str();
  data.seed = arguments.seed;
  write_dataset(arguments.output, data);
  std::printf("%s: %u boundaries, %u objects, %ju ones\n", arguments.output.c_str(), data.matrix.shape().rows,
              data.matrix.shape().columns, std::uintmax_t{data.matrix.ones()});
}

}  // namespace

void add_generate(CLI::App& app) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* verb =
      app.add_subcommand("generate", "Make a matrix like those of a power plant or a city, up to 10^9 ones");
  verb->footer(
      "Rows are boundaries between view cells, columns the objects that appear or vanish there. At --scale 1 "
      "the sizes of\n"
      "Chhugani et al. 2005: 350,000 x 400,000 (5.2e8 ones, 4.2 GB to make) and 700,000 x 790,000 (1.0e9, 8 "
      "GB).\n"
      "Example: vismat generate power-plant --scale 0.0625 -o plant.bsp.h5");
  verb->add_option("SCENE", arguments->scene, "power-plant or city")
      ->required()
      ->check(CLI::IsMember({"power-plant", "city"}));
  verb->add_option("--scale", arguments->scale, "Share of the papers' size, above 0, at most 1")
      ->check(CLI::Range(1e-4, 1.))
      ->capture_default_str();
  verb->add_flag("--harder", arguments->harder, "Less redundant: more of each object's view is its own");
  verb->add_option("--seed", arguments->seed, "Another seed, another scene")->capture_default_str();
  verb->add_option("-o,--output", arguments->output, "Matrix file to write, .bsp.h5 or .mtx")->required();
  verb->callback([arguments] { run(*arguments); });
}

}  // namespace vismat::cli
