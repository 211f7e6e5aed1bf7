// vismat walk: replays a camera path through a baked scene.
#include "runtime/walks/walk.h"

#include <cinttypes>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "cli/summary.h"
#include "cli/verbs.h"
#include "matrix/base/atomic_file.h"
#include "programs/measuring.h"
#include "programs/options.h"
#include "programs/progress.h"

namespace vismat::cli {
namespace {

struct WalkArguments {
  std::string folder;  // no file that an output could replace
  std::filesystem::path path, log, summary;
  std::string mode = "wait", disk = "disk-2004";
  WalkOptions options;
};

nlohmann::ordered_json to_json(const WalkSummary& s, const WalkOptions& options) {
  return {{"system", options.system},
          {"mode", options.mode == WalkMode::wait ? "wait" : "deadline"},
          {"disk", options.disk.name},
          {"cache_bytes", options.cache_bytes},
          {"prefetch_depth", options.prefetch_depth},
          {"seed", options.seed},
          {"frames", s.frames},
          {"frames_without_cell", s.frames_without_cell},
          {"crossings", s.crossings},
          {"jumps", s.jumps},
          {"seconds", s.seconds},
          {"requests", s.requests},
          {"hits", s.hits},
          {"reads", s.reads},
          {"pages", s.pages},
          {"bytes", s.bytes},
          {"prefetched", s.prefetched},
          {"evicted", s.evicted},
          {"overflow", s.overflow},
          {"failed", s.failed},
          {"late", s.late},
          {"most_cached_bytes", s.most_cached_bytes},
          {"stalled_frames", s.stalled_frames},
          {"stalled_frames_after_the_first_cell", s.stalled_frames_after_the_first_cell},
          {"stall_ms", s.stall_ms},
          {"p99_stall_ms", s.p99_stall_ms},
          {"worst_stall_ms", s.worst_stall_ms},
          {"mean_frame_ms", s.mean_frame_ms},
          {"frame_ms_variance", s.frame_ms_variance},
          {"worst_frame_ms", s.worst_frame_ms},
          {"mean_triangles", s.mean_triangles},
          {"mean_objects", s.mean_objects},
          {"mean_versions", s.mean_versions},
          {"images", s.images},
          {"missing_pixels", s.errors.missing},
          {"wrong_pixels", s.errors.wrong},
          {"extra_pixels", s.errors.extra},
          {"worst_image_pixels", s.worst_image},
          {"p95_image_pixels", s.p95_image}};
}

void print(const WalkSummary& s, const Walk& walk) {
  line("frames", grouped(s.frames) + " in view cells, " + grouped(s.frames_without_cell) + " in none");
  line("boundaries", grouped(s.crossings) + " crossed, " + grouped(s.jumps) + " cells loaded whole");
  line("read", grouped(s.bytes) + " bytes in " + grouped(s.reads) + " reads; " + grouped(s.hits) + " of " +
                   grouped(s.requests) + " chunks were there");
  line("cache", grouped(s.most_cached_bytes) + " bytes at most, " + grouped(s.evicted) + " chunks evicted, " +
                    grouped(s.overflow) + " had no room");
  line("drawn",
       formatted("%.0f objects, ", s.mean_objects) + formatted("%.0f triangles a frame", s.mean_triangles));
  line("stalls", grouped(s.stalled_frames_after_the_first_cell) + " frames after the first cell; " +
                     formatted("%.1f ms in all, ", s.stall_ms) + formatted("p99 %.2f ms, ", s.p99_stall_ms) +
                     formatted("worst %.1f ms", s.worst_stall_ms));
  line("frame time",
       formatted("%.2f ms on average, ", s.mean_frame_ms) + formatted("variance %.2f", s.frame_ms_variance));
  if (s.failed + s.late > 0) line("not drawn", grouped(s.failed) + " damaged, " + grouped(s.late) + " late");
  if (s.images > 0) {
    line("wrong pixels", grouped(s.errors.all()) + " of " + grouped(s.pixels) + " in " + grouped(s.images) +
                             " images: " + grouped(s.errors.missing) + " missing, " +
                             grouped(s.errors.wrong) + " wrong, " + grouped(s.errors.extra) + " extra");
  }
  for (const std::string& fault : walk.faults) std::fprintf(stderr, "vismat: %s\n", fault.c_str());
}

void run_walk(WalkArguments arguments) {
  WalkOptions& options = arguments.options;
  options.mode = arguments.mode == "wait" ? WalkMode::wait : WalkMode::deadline;
  options.disk = parse_disk_model(arguments.disk);
  const BakedScene scene(arguments.folder);
  const CameraPath path = read_camera_path(arguments.path);
  const double begin = wall_seconds();
  const Walk done = walk(scene, path, options, show_progress("walking"));
  const double seconds = wall_seconds() - begin;
  const WalkSummary summary = summary_of(done.frames, options.screen);
  const auto write = [](const std::filesystem::path& file, const std::string& text) {
    if (!file.empty()) write_file(file, std::as_bytes(std::span(text)));
  };
  write(arguments.log, to_csv(done.frames));
  write(arguments.summary, to_json(summary, options).dump(2) + "\n");
  print(summary, done);
  line("replayed", formatted("in %.2f s, ", seconds) +
                       formatted("%.0f frames a second", static_cast<double>(done.frames.size()) / seconds));
}

std::string ideas() {
  std::string text;
  for (const WalkSystemInfo& system : walk_systems())
    text += std::string(system.name) + ": " + std::string(system.idea) + ".\n";
  return text;
}

}  // namespace

void add_walk(Program& program) {
  const auto arguments = std::make_shared<WalkArguments>();
  WalkOptions& o = arguments->options;
  const Verb verb =
      program.verb("walk", "Replay a camera path through a baked scene: what is read, decoded, drawn, late");
  verb.option("BAKE", arguments->folder, "The folder that 'vismat bake' made").required();
  verb.input("PATH", arguments->path, "The camera path, see 'vismat path'").required();
  std::vector<std::string> names;
  for (const WalkSystemInfo& system : walk_systems()) names.emplace_back(system.name);
  verb.option("--system", o.system, "Run-time system; see below").one_of(names);
  verb.option("--mode", arguments->mode,
              "wait: a frame ends when its data is there; deadline: it draws what is there")
      .one_of({"wait", "deadline"});
  verb.option("--frames", o.frames, "Number of frames along the path").between(1, 1e7);
  verb.option(
      "--disk", arguments->disk,
      "Virtual disk: disk-2004, sata-ssd, nvme, network, or LATENCY_MS,MB_PER_S,CHANNELS[,JITTER_MS]");
  verb.option("--cache", o.cache_bytes, "Budget of the cache, such as 64M").size_in_bytes();
  verb.option("--prefetch", o.prefetch_depth, "Cells up to so many boundaries away are prefetched; 0: none");
  verb.option("--images", o.image_every, "Draw every so many frames and count wrong pixels; 0: no images");
  verb.option("--width", o.screen.width, "Width of the picture in pixels").positive();
  verb.option("--height", o.screen.height, "Height of the picture in pixels").positive();
  verb.option("--field-of-view", o.screen.field_of_view, "Horizontal field of view in degrees");
  verb.option("--near", o.near, "Distance of the near plane in metres");
  verb.option("--triangles", o.prices.triangles_per_second, "Triangles that are drawn a second").positive();
  verb.option("--seed", o.seed, "Random seed of the disk's jitter");
  verb.threads(o.threads);
  verb.output("--log", arguments->log, Written::text, "Also write a line for each frame (.csv)");
  verb.output("--summary", arguments->summary, Written::text, "Also write the sums (.json)");
  verb.note(ideas());
  verb.example("vismat walk dense8.bake dense8.path --images 10 --log walk.csv");
  verb.runs([arguments] { run_walk(*arguments); });
}

}  // namespace vismat::cli
