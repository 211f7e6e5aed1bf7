// vismat path: makes, checks, resamples and converts camera paths.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <numbers>
#include <optional>
#include <set>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "cli/summary.h"
#include "cli/verbs.h"
#include "matrix/base/atomic_file.h"
#include "matrix/files/hdf5_file.h"
#include "programs/options.h"
#include "runtime/camera/cell_finder.h"
#include "runtime/camera/passages.h"
#include "runtime/camera/path_makers.h"
#include "visibility/scene_file.h"

namespace vismat::cli {
namespace {

struct PathArguments {
  std::filesystem::path in, scene, out;
  std::optional<std::uint32_t> frames;
  std::string from, to;
  std::string kind;
  std::optional<double> seconds, speed, turn;
  std::optional<std::uint32_t> boundaries, way;
  std::optional<std::uint64_t> seed;
};

CameraAxes axes_named(const std::string& name) {
  return name == "tum" ? CameraAxes::tum : CameraAxes::opengl;
}

PathOptions path_options(const PathArguments& arguments) {
  PathOptions options;
  for (const PathKindName& kind : path_kinds()) {
    if (kind.name == arguments.kind) options.kind = kind.kind;
  }
  options.seconds = arguments.seconds.value_or(options.seconds);
  options.boundaries = arguments.boundaries;
  options.speed = arguments.speed.value_or(options.speed);
  options.turn = arguments.turn.value_or(options.turn);
  options.way = arguments.way.value_or(options.way);
  options.seed = arguments.seed.value_or(options.seed);
  return options;
}

/// An option that says how a path is made, if one was given.
std::string option_of_making(const PathArguments& a) {
  if (!a.kind.empty()) return "--kind";
  if (a.seconds) return "--seconds";
  if (a.boundaries) return "--boundaries";
  if (a.speed) return "--speed";
  if (a.turn) return "--turn";
  if (a.way) return "--way";
  return a.seed ? "--seed" : "";
}

double degrees_between(const glm::dquat& a, const glm::dquat& b) {
  const glm::dquat turn = glm::conjugate(a) * b;
  return 360 / std::numbers::pi * std::atan2(std::hypot(turn.x, turn.y, turn.z), std::abs(turn.w));
}

void print_motion(const CameraPath& path) {
  double metres = 0, degrees = 0, fastest = 0, turns = 0, farthest = 0;
  std::uint64_t jumps = 0;
  for (std::size_t i = 1; i < path.poses().size(); ++i) {
    const Pose &a = path.poses()[i - 1], &b = path.poses()[i];
    const double way = glm::distance(a.position, b.position), turn = degrees_between(a.rotation, b.rotation);
    const double time = b.time - a.time;
    if (time == 0) {
      ++jumps;
      farthest = std::max(farthest, way);
      continue;
    }
    metres += way;
    degrees += turn;
    fastest = std::max(fastest, way / time);
    turns = std::max(turns, turn / time);
  }
  const double seconds = path.end() - path.begin();
  line("poses",
       grouped(path.poses().size()) + formatted(", from %.10g to %.10g s", path.begin(), path.end()));
  line("way", formatted("%.4g m in %.4g s", metres, seconds));
  line("jumps", jumps == 0 ? "none" : grouped(jumps) + formatted(", the longest %.3g m", farthest));
  if (seconds == 0) return;
  line("speed", formatted("mean %.3g m/s, at most %.3g m/s", metres / seconds, fastest));
  line("turning", formatted("mean %.3g degrees/s, at most %.3g degrees/s", degrees / seconds, turns));
}

/// The poses, and between any two one at least: a pose in a corner of cells does not tell which one was walked through. No two are
/// more than a tenth of a second apart on paths of less than a day.
std::vector<Pose> closely(const CameraPath& path) {
  const double step = std::max(0.1, (path.end() - path.begin()) / 1e6);
  std::vector<Pose> poses;
  for (const Pose& pose : path.poses()) {
    if (!poses.empty()) {
      const double before = poses.back().time;
      const double parts = pose.time > before ? std::max(2., std::ceil((pose.time - before) / step)) : 1;
      for (double part = 1; part < parts; ++part)
        poses.push_back(path.at(before + (pose.time - before) * (part / parts)));
    }
    poses.push_back(pose);
  }
  return poses;
}

void print_cells(const CameraPath& path, const ViewCells& cells) {
  const std::vector<std::uint32_t> along = cells_along(CellFinder(cells), closely(path));
  const VisibilityMatrix neighbours = cell_neighbours(cells);
  std::set<std::uint32_t> visited(along.begin(), along.end());
  visited.erase(CellFinder::none);
  std::uint64_t changes = 0, far = 0;
  for (std::size_t i = 1; i < along.size(); ++i) {
    const std::uint32_t a = along[i - 1], b = along[i];
    if (a == b || a == CellFinder::none || b == CellFinder::none) continue;
    ++changes;
    far += !neighbours.contains(a, b);
  }
  const auto outside = static_cast<std::uint64_t>(std::ranges::count(along, CellFinder::none));
  line("view cells", grouped(visited.size()) + " of " + grouped(cells.count()) + ", " + grouped(changes) +
                         " changes, of which " + grouped(far) + " to a cell that is no neighbour");
  line("in no cell", formatted("%.3g %% of the moments looked at",
                               100 * static_cast<double>(outside) / static_cast<double>(along.size())));
}

CameraPath made_path(const PathArguments& arguments, SceneFile& scene) {
  if (arguments.out.empty())
    throw std::invalid_argument(arguments.in.string() + ": a scene; name the path to make, -o");
  if (!arguments.from.empty())
    throw std::invalid_argument(arguments.in.string() +
                                ": a scene; --from tells the axes of a path that is read");
  scene = read_scene(arguments.in);
  try {
    return make_camera_path(scene.scene, scene.cells, path_options(arguments));
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(arguments.in.string() + ": " + error.what());
  }
}

CameraPath given_path(const PathArguments& arguments) {
  if (const std::string option = option_of_making(arguments); !option.empty()) {
    throw std::invalid_argument(arguments.in.string() + ": no scene file (.scene.h5), which " + option +
                                " is for");
  }
  return read_camera_path(arguments.in, axes_named(arguments.from));
}

void run_path(const PathArguments& arguments) {
  const bool made = is_hdf5(arguments.in);
  std::optional<SceneFile> scene;
  CameraPath path = made ? made_path(arguments, scene.emplace()) : given_path(arguments);
  if (!arguments.scene.empty()) scene = read_scene(arguments.scene);
  if (arguments.frames) path = CameraPath(path.frames(*arguments.frames));
  if (!arguments.out.empty()) {
    const std::string text = to_text(path, axes_named(arguments.to));
    write_file(arguments.out, std::as_bytes(std::span(text)));
  }
  print_motion(path);
  if (scene) print_cells(path, scene->cells);
}

}  // namespace

void add_path(Program& program) {
  const auto a = std::make_shared<PathArguments>();
  const Verb verb =
      program.verb("path", "Make a camera path through view cells; check, resample or convert one");
  verb.input("INPUT", a->in,
             "A scene file with view cells, through which a path is made; or a camera path, a text of one "
             "pose a line")
      .required();
  const Option out = verb.output("-o,--output", a->out, Written::text,
                                 "The camera path to write, as text; without it a path is only checked");
  std::vector<std::string> kinds;
  for (const PathKindName& kind : path_kinds()) kinds.emplace_back(kind.name);
  verb.option("--kind", a->kind,
              "walk (default): by shortest ways to random view cells, along streets and through doors; "
              "turning: a walk "
              "with looks to the left and right; to-and-fro: between two view cells; spin: on the spot; "
              "roofs: to "
              "view cells over roofs; teleport: a walk with a jump every 5 s")
      .one_of(kinds);
  const Option seconds =
      verb.option("--seconds", a->seconds, "How long the path to make is (default: 60)").between(1e-3, 1e5);
  verb.option("--boundaries", a->boundaries,
              "End the path to make behind so many boundaries between view cells")
      .between(1, 1e6)
      .excludes(seconds);
  verb.option("--speed", a->speed, "Of the viewer, in metres a second (default: 1.5)").between(1e-3, 1000);
  verb.option("--turn", a->turn, "Degrees a second that the viewer turns at most (default: 120)")
      .between(1, 3600);
  verb.option("--way", a->way, "Boundaries between the ends of to-and-fro (default: 1)").between(1, 1e6);
  verb.option("--seed", a->seed, "Another seed makes another path (default: 1)");
  verb.option("--frames", a->frames,
              "Write the poses of exactly so many frames instead, evenly spaced in time from the first to "
              "the last")
      .between(1, 1e7)
      .needs(out);
  verb.option("--from", a->from,
              "The camera's axes in the path that is read: opengl (default; y up, looks along -z: "
              "OpenSceneGraph), tum (y "
              "down, looks along +z: TUM RGB-D and computer vision)")
      .one_of({"opengl", "tum"});
  verb.option("--to", a->to, "The camera's axes in the path that is written (default: opengl)")
      .one_of({"opengl", "tum"})
      .needs(out);
  verb.input("--scene", a->scene, "A scene file with view cells: tell in which of them the path is");
  verb.example("vismat path city.scene.h5 --kind walk --seconds 60 --speed 1.5 --seed 1 -o walk.path");
  verb.example("vismat path walk.path --scene city.scene.h5");
  verb.example("vismat path walk.path --frames 1000 -o frames.path");
  verb.example("vismat path groundtruth.txt --from tum --to opengl -o room.path");
  verb.runs([a] { run_path(*a); });
}

}  // namespace vismat::cli
