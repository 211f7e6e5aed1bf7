// Measures over-estimation and missed objects against milliseconds for a view cell, for every producer.
//
// Scenes are named as in bench/visibility_study.h, or are files. At each of a few places several neighbouring view cells are taken,
// since sampling shares rays between neighbours. Times are processor milliseconds of one thread for a view cell: the median and the
// range over the places. The time for a scene's occluders and ray tree is given apart. Every line is compared with rays first: if a
// ray reaches an object that a run reported hidden, that is said, and the verb ends with exit code 1.
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <glm/geometric.hpp>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "bench/verbs.h"
#include "bench/visibility_study.h"
#include "programs/csv.h"
#include "programs/measuring.h"
#include "programs/names.h"
#include "visibility/shadows/projection_point.h"

namespace vismat::bench {
namespace {

struct VisibilityTablesOptions {
  std::vector<std::string> scenes;
  std::filesystem::path csv;
  std::uint32_t places = 4, each = 4;
  bool append = false, long_runs = false;
};

/// Any point of the cell, with equal chance.
glm::dvec3 random_point(const Convex& cell, Random& random) {
  glm::dvec3 low = cell.vertices[0], high = low;
  for (const glm::dvec3& vertex : cell.vertices) {
    for (int k = 0; k < 3; ++k) low[k] = std::min(low[k], vertex[k]), high[k] = std::max(high[k], vertex[k]);
  }
  for (;;) {
    glm::dvec3 point;
    for (int k = 0; k < 3; ++k) point[k] = low[k] + random.fraction() * (high[k] - low[k]);
    if (std::all_of(cell.faces.begin(), cell.faces.end(), [&](const Convex::Face& face) {
          return glm::dot(face.normal, point) <= face.offset + 1e-9;
        })) {
      return point;
    }
  }
}

void add_shadows(Study& study, const Shadows& shadows, double preparing_ms) {
  const auto shadow = [&](const std::string& settings, const ShadowOptions& options,
                          const char* producer = "shadow") {
    BoundsOptions bounds;
    bounds.shadow = options;
    study.run(
        producer, settings, true, false,
        [&](const ViewCells& cells, JobRunner& runner) {
          return see_bounds(shadows, nullptr, cells, bounds, runner);
        },
        preparing_ms);
  };
  for (const std::uint32_t resolution : {128, 256, 512, 1024}) {
    ShadowOptions options;
    options.resolution = resolution;
    shadow(std::to_string(resolution) + " px", options);
  }
  ShadowOptions options = effort(0).shadow;
  for (const std::uint32_t points : {9, 27}) {
    options.points = points;
    shadow(std::to_string(points) + " points" + (points == effort(0).shadow.points ? " (effort 0)" : ""),
           options);
  }
  options.points = 1;
  shadow("centre", options, "point");
  options.only_point = [random = Random(9)](const Convex& cell, std::span<const Shrinkage>) mutable {
    return random_point(cell, random);
  };
  shadow("random", options, "point");
  for (const auto& [name, objective] : {std::pair("apexes (published)", ProjectionObjective::apexes),
                                        std::pair("areas (ours)", ProjectionObjective::areas)}) {
    options.only_point = [objective = objective](const Convex& cell, std::span<const Shrinkage> occluders) {
      return projection_point(cell, occluders, objective);
    };
    shadow(name, options, "point");
    ShadowOptions with_centre = effort(0).shadow;
    with_centre.points = 1;
    with_centre.best_point = objective;
    shadow(std::string(name) + " and centre", with_centre, "point");
  }
}

void add_rays(Study& study, const Shadows& shadows, double preparing_ms, bool long_runs) {
  for (const std::uint64_t budget : {500, 2000, 20000, 100000}) {
    SampledOptions options;
    options.rays = budget;
    study.run("sampled", std::to_string(budget) + " rays a round", false, true,
              [&](const ViewCells& cells, JobRunner& runner) {
                return see_by_sampling(study.rays(), cells, options, runner);
              });
  }
  const auto sandwich = [&](const std::string& settings, const BoundsOptions& options) {
    study.run(
        "sandwich", settings, true, true,
        [&](const ViewCells& cells, JobRunner& runner) {
          return see_bounds(shadows, &study.rays(), cells, options, runner);
        },
        preparing_ms);
  };
  BoundsOptions options = effort(1);
  for (const std::uint32_t patches : {0, 12}) {
    options.shadow.patches = patches;
    sandwich(std::to_string(patches) + " patches", options);
  }
  sandwich("effort 1", effort(1));
  options = effort(2);
  options.shadow.patches = 150;
  sandwich("150 patches", options);
  sandwich("effort 2", effort(2));
  if (long_runs) {
    options.shadow.patches = 2000;
    sandwich("2000 patches", options);
  }
}

void run_visibility_tables(const VisibilityTablesOptions& options) {
  std::string csv = table_begin(options.csv, Study::header, options.append);
  std::uint64_t wrong = 0;
  for (const std::string& name : options.scenes) {
    const SceneFile file = study_scene(name);
    const double busy = processor_seconds();
    const Shadows shadows(file.scene, find_occluders(file.scene));
    const double preparing_ms = 1e3 * (processor_seconds() - busy);
    Study study(scene_name(name), file.scene, places_of(file.cells, options.places, options.each));
    add_shadows(study, shadows, preparing_ms);
    add_rays(study, shadows, preparing_ms, options.long_runs);
    const std::string lines = study.lines(wrong);
    std::printf("%s", lines.c_str());
    std::fflush(stdout);
    csv += lines;
    write_table(options.csv, csv);
  }
  if (wrong > 0) throw std::runtime_error(std::to_string(wrong) + " objects are hidden that rays reach");
}

}  // namespace

void add_visibility_tables(const Verb& verb) {
  const auto o = std::make_shared<VisibilityTablesOptions>();
  verb.input("SCENE", o->scenes, "Scenes: dense-city, box-city, plant, soup, tilted-boxes, or scene files")
      .required();
  verb.output("--csv", o->csv, Written::text, "File for the table as CSV");
  verb.flag("--append", o->append, "Add to that file instead of replacing it");
  verb.option("--places", o->places, "Number of places, spread over the scene").between(1u, 1000u);
  verb.option("--cells", o->each, "Number of view cells at each place").between(1u, 1000u);
  verb.flag("--long", o->long_runs, "Also with 2000 patches of the view cell's surface, which takes long");
  verb.example("bench visibility-tables dense-city --places 2 --cells 2 --csv tables.csv");
  verb.runs([o] { run_visibility_tables(*o); });
}

}  // namespace vismat::bench
