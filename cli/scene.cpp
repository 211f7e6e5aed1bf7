// vismat scene: makes a scene file from any triangles.
#include <algorithm>
#include <cstdio>
#include <map>
#include <memory>

#include "cli/summary.h"
#include "cli/verbs.h"
#include "programs/options.h"
#include "visibility/meshes/any_scene.h"

namespace vismat::cli {
namespace {

struct SceneArguments {
  std::string input, output, objects, up = "z";
  AnySceneOptions options;
};

void run_scene(SceneArguments arguments) {
  using Objects = AnySceneOptions::Objects;
  static const std::map<std::string, Objects> objects = {{"components", Objects::components},
                                                         {"one-a-triangle", Objects::triangles},
                                                         {"keep", Objects::as_given}};
  if (!arguments.objects.empty()) arguments.options.objects = objects.at(arguments.objects);
  arguments.options.y_up = arguments.up == "y";
  const auto [file, welded] = read_any_scene(arguments.input, arguments.options);
  write_scene(arguments.output, file);
  const Scene& scene = file.scene;
  std::printf("%s: %s objects, %s triangles, %s vertices", arguments.output.c_str(),
              grouped(scene.object_count).c_str(), grouped(scene.object_of_triangle.size()).c_str(),
              grouped(scene.vertices.size()).c_str());
  const auto tell = [](std::uint64_t count, const char* what) {
    if (count > 0) std::printf("; %s %s", grouped(count).c_str(), what);
  };
  tell(static_cast<std::uint64_t>(std::count(scene.see_through.begin(), scene.see_through.end(), 1)),
       "see-through objects");
  tell(welded.zero_area, "triangles without area left out");
  tell(welded.duplicates, "duplicate triangles left out");
  tell(welded.non_manifold_edges, "edges with more than two triangles");
  std::printf("\n");
}

}  // namespace

void add_scene(Program& program) {
  const auto arguments = std::make_shared<SceneArguments>();
  AnySceneOptions& o = arguments->options;
  const Verb verb = program.verb("scene", "Make a scene file from a mesh, a level or another scene file");
  verb.input("INPUT", arguments->input, "The file that holds the triangles").required();
  verb.output(arguments->output, Written::scene, "The scene file to write (.scene.h5)");
  verb.option("--objects", arguments->objects,
              "What becomes an object. components: triangles that share vertices, which is a mesh's default; "
              "one-a-triangle; keep: a level's faces or a scene's objects, which is their default")
      .one_of({"components", "one-a-triangle", "keep"});
  verb.option("--weld", o.weld,
              "Vertices within this distance in metres become one; 0 joins only equal vertices");
  verb.option("--scale", o.scale, "Length of a mesh's unit in metres");
  verb.option("--up", arguments->up, "The axis of a mesh that points up").one_of({"y", "z"});
  verb.note(
      "INPUT is a mesh (.obj, .ply, .off, .stl), a Quake 3 level (FILE.bsp, FILE.pk3:maps/NAME.bsp) or a "
      ".scene.h5.");
  verb.example("vismat scene station.obj --scale 0.01 --up y -o station.scene.h5");
  verb.runs([arguments] { run_scene(*arguments); });
}

}  // namespace vismat::cli
