// vismat generate: makes synthetic matrices like those of the large scenes of Chhugani et al. 2005.
#include "matrix/generate.h"

#include <cstdio>
#include <memory>
#include <sstream>
#include <string>

#include "cli/verbs.h"
#include "cli/vmat_files.h"
#include "programs/options.h"

namespace vismat::cli {
namespace {

struct GenerateArguments {
  std::string scene, output;
  double scale = 1. / 64;
  bool harder = false;
  std::uint64_t seed = 1;
};

void run_generate(const GenerateArguments& arguments) {
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
  write_matrix(arguments.output, data);
  std::printf("%s: %u boundaries, %u objects, %ju ones\n", arguments.output.c_str(), data.matrix.shape().rows,
              data.matrix.shape().columns, std::uintmax_t{data.matrix.ones()});
}

}  // namespace

void add_generate(Program& program) {
  const auto arguments = std::make_shared<GenerateArguments>();
  const Verb verb = program.verb(
      "generate", "Make a random matrix of differences like those of Chhugani et al. 2005, without a scene");
  verb.option("MODEL", arguments->scene,
              "Which scene of Chhugani et al. 2005 the matrix imitates (no scene is made)")
      .required()
      .one_of({"power-plant", "city"});
  verb.option("--scale", arguments->scale, "Size as a share of the published scene's").between(1e-4, 1);
  verb.flag("--harder", arguments->harder,
            "Make a less redundant matrix, in which view cells have less in common");
  verb.option("--seed", arguments->seed, "Another seed makes another matrix");
  verb.output(arguments->output, Written::matrix, "The matrix file to write (.bsp.h5, .mtx, .npy or .npz)");
  verb.note(
      "Rows are boundaries between view cells; columns are the objects that appear or vanish there. --scale "
      "1 makes the sizes of Chhugani et al. 2005: 350,000 x 400,000 (5.2e8 ones, which takes 4.2 GB of "
      "memory) and 700,000 x 790,000 (1.0e9 ones, 8 GB).");
  verb.example("vismat generate power-plant --scale 0.0625 -o power-plant.bsp.h5");
  verb.runs([arguments] { run_generate(*arguments); });
}

}  // namespace vismat::cli
