// vismat scene: any triangles to a scene file.
#include <algorithm>
#include <cstdio>
#include <map>
#include <memory>

#include "cli/summary.h"
#include "cli/verbs.h"
#include "visibility/meshes/any_scene.h"

namespace vismat::cli {
namespace {

struct Arguments {
  std::string input, output, objects, up = "z";
  AnySceneOptions options;
};

void run(Arguments arguments) {
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
  tell(welded.duplicates, "double triangles left out");
  tell(welded.non_manifold_edges, "edges with more than two triangles");
  std::printf("\n");
}

}  // namespace

void add_scene(CLI::App& app) {
  auto arguments = std::make_shared<Arguments>();
  AnySceneOptions& o = arguments->options;
  CLI::App* verb = app.add_subcommand("scene", "Make a scene file of a mesh, a level or another scene file");
  verb->footer(
      "INPUT is a mesh (.obj, .ply, .off, .stl), a Quake-3 level (FILE.bsp, FILE.pk3:maps/NAME.bsp) or a "
      ".scene.h5.\n"
      "Example: vismat scene station.obj --scale 0.01 --up y -o station.scene.h5");
  verb->add_option("INPUT", arguments->input, "What holds the triangles")->required();
  verb->add_option("-o,--output", arguments->output, "The scene file to write (.scene.h5)")->required();
  verb->add_option("--objects", arguments->objects,
                   "components: triangles that share vertices (a mesh's default); keep: a level's faces, a "
                   "scene's objects")
      ->check(CLI::IsMember({"components", "one-a-triangle", "keep"}));
  verb->add_option("--weld", o.weld, "Vertices within this distance become one, metres; 0: equal ones")
      ->capture_default_str();
  verb->add_option("--scale", o.scale, "Metres for each unit of a mesh")->capture_default_str();
  verb->add_option("--up", arguments->up, "Which axis of a mesh points up")
      ->check(CLI::IsMember({"y", "z"}))
      ->capture_default_str();
  verb->callback([arguments] { run(*arguments); });
}

}  // namespace vismat::cli
