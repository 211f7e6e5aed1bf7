// Replays a camera path through a baked scene under one of several run-time systems, on a virtual clock and disk.
#pragma once
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "matrix/base/parallel.h"
#include "runtime/camera/camera_path.h"
#include "runtime/storage/virtual_disk.h"
#include "runtime/walks/baked_scene.h"
#include "runtime/walks/walk_log.h"

namespace vismat {

/// wait: a frame ends when its data is there; the delay is the stall, and images are right. deadline: a frame draws
/// what is there, and what is missing is counted. The poses are the path's in both.
enum class WalkMode { wait, deadline };

/// What work costs on the virtual clock.
struct WalkPrices {
  double triangles_per_second = 3.5e6;  // drawn; 3 to 4 million in 2005 [Chhugani et al. 2005, section 8]
  double culling_ns = 100;              // for each box that is compared with the frustum
  double list_ns = 1000, id_ns = 10;    // to decode a row or list, and for each id in it
};

struct WalkOptions {
  std::string system = "vlod";  // a name of walk_systems()
  WalkMode mode = WalkMode::wait;
  std::uint32_t frames = 1000;
  Screen screen{640, 360, 90};
  double near = 0.1;  // metres
  DiskModel disk = disk_model("disk-2004");
  std::uint64_t cache_bytes = std::uint64_t{512} << 20;  // [Chhugani et al. 2005, section 8]
  std::uint32_t prefetch_depth = 1;  // boundaries from the viewer's cell; 0: no prefetching
  WalkPrices prices;
  std::uint32_t image_every = 0;  // an image for every so many frames; 0: none
  std::uint64_t seed = 1;         // of the disk's jitter
  unsigned threads = 0;           // that read and draw; 0: one for each core
};

/// A frame's images, where there are any.
using OnImages =
    std::function<void(const FrameRecord& frame, const ItemImage& drawn, const ItemImage& reference)>;

struct Walk {
  std::vector<FrameRecord> frames;
  /// What went wrong on the way, each with the file and chunk that it is about, and the frame.
  std::vector<std::string> faults;
};

/// The same scene, path and options, threads apart, give the same frames, byte for byte, images included on one kind of
/// CPU. A chunk that is missing, cut or corrupt is reported and left out, and the walk goes on. Throws
/// std::invalid_argument for options out of range, such as a budget that the largest chunk does not fit in.
Walk walk(const BakedScene& scene, const CameraPath& path, const WalkOptions& options,
          const Progress& progress = {}, const OnImages& on_images = {});

/// A run-time system, for tables and help.
struct WalkSystemInfo {
  std::string_view name, idea;
  bool conservative;  // shows no wrong pixel in mode `wait`
};
std::span<const WalkSystemInfo> walk_systems();

}  // namespace vismat
