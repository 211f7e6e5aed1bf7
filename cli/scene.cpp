// vismat scene: makes a scene file from any triangles.
#include <cstdio>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "cli/summary.h"
#include "cli/verbs.h"
#include "matrix/base/number_list.h"
#include "programs/options.h"
#include "visibility/meshes/any_scene.h"

namespace vismat::cli {
namespace {

struct SceneArguments {
  std::string input, output, objects, up = "z", origin = "auto";
  AnySceneOptions options;
};

/// Takes the words of --objects and --origin.
void parse_words(SceneArguments& arguments) {
  using Objects = AnySceneOptions::Objects;
  static const std::map<std::string, Objects> objects = {{"components", Objects::components},
                                                         {"groups", Objects::groups},
                                                         {"materials", Objects::materials},
                                                         {"one-a-triangle", Objects::triangles},
                                                         {"keep", Objects::as_given}};
  AnySceneOptions& options = arguments.options;
  if (const std::string& word = arguments.objects; word.starts_with("tiles:")) {
    options.objects = Objects::tiles;
    const std::vector<double> side = number_list(word.substr(6));
    if (side.size() != 1 || !(side[0] > 0)) {
      throw std::invalid_argument("--objects '" + word + "': need tiles:METRES, the side of a tile, above 0");
    }
    options.tile = static_cast<float>(side[0]);
  } else if (!word.empty()) {
    const auto found = objects.find(word);
    if (found == objects.end()) {
      throw std::invalid_argument(
          "--objects '" + word +
          "': need components, groups, materials, tiles:METRES, one-a-triangle or keep");
    }
    options.objects = found->second;
  }
  options.placement.y_up = arguments.up == "y";
  if (arguments.origin != "auto") {
    const std::vector<double> at = number_list(arguments.origin);
    if (at.size() != 3)
      throw std::invalid_argument("--origin '" + arguments.origin + "': need auto, or three numbers x,y,z");
    options.placement.origin = {at[0], at[1], at[2]};
  }
}

void run_scene(SceneArguments arguments) {
  parse_words(arguments);
  const auto [file, welded, left_out, notes] = read_any_scene(arguments.input, arguments.options);
  write_scene(arguments.output, file);
  const Scene& scene = file.scene;
  std::printf("%s: %s objects, %s triangles, %s vertices", arguments.output.c_str(),
              grouped(scene.object_count).c_str(), grouped(scene.object_of_triangle.size()).c_str(),
              grouped(scene.vertices.size()).c_str());
  const auto tell = [](std::uint64_t count, const char* what) {
    if (count > 0) std::printf("; %s %s", grouped(count).c_str(), what);
  };
  tell(see_through_objects(scene), "see-through objects");
  tell(welded.zero_area, "triangles without area left out");
  tell(welded.duplicates, "duplicate triangles left out");
  tell(welded.non_manifold_edges, "edges with more than two triangles");
  for (const std::string& what : left_out) std::printf("; %s", what.c_str());
  std::printf("\n");
  print_extent(file);
  for (const std::string& note : notes) line("note", note);
}

}  // namespace

void add_scene(Program& program) {
  const auto arguments = std::make_shared<SceneArguments>();
  AnySceneOptions& o = arguments->options;
  const Verb verb = program.verb("scene", "Make a scene file from a mesh, a level or another scene file");
  verb.input("INPUT", arguments->input, "The file that holds the triangles").required();
  verb.output(arguments->output, Written::scene, "The scene file to write (.scene.h5)");
  verb.option(
      "--objects", arguments->objects,
      "What becomes an object. components: triangles that share vertices, which is a mesh's default; "
      "groups: those that an OBJ file names by o and g, or the solids of an STL file; materials: those "
      "of an OBJ file; tiles:METRES: squares of the ground; one-a-triangle; keep: a level's faces or a "
      "scene's objects, which is their default");
  verb.option("--see-through", o.see_through,
              "Groups and materials whose names this regular expression is found in hide nothing, such as "
              "'glass|leaf'; so do materials that an OBJ file's .mtl file says are transparent");
  verb.option("--weld", o.weld,
              "Vertices within this distance in metres become one; 0 joins only equal vertices");
  verb.option("--scale", o.placement.scale, "Length of a mesh's unit in metres");
  verb.option("--up", arguments->up, "The axis of a mesh that points up").one_of({"y", "z"});
  verb.option(
      "--origin", arguments->origin,
      "What becomes (0, 0, 0), as x,y,z in metres, since coordinates of maps are too large for 32-bit "
      "numbers; auto moves a mesh that is far from 0 by whole kilometres");
  verb.note(
      "INPUT is a mesh (.obj, .ply, .off, .stl, also packed as .obj.gz), a Quake 3 level (FILE.bsp, "
      "FILE.pk3:maps/NAME.bsp) or a "
      ".scene.h5.");
  verb.example("vismat scene station.obj --scale 0.01 --up y -o station.scene.h5");
  verb.runs([arguments] { run_scene(*arguments); });
}

}  // namespace vismat::cli
