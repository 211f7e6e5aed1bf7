#include "runtime/walks/walk.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <iterator>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <thread>
#include <utility>

#include "runtime/camera/cell_finder.h"
#include "runtime/walks/systems.h"

namespace vismat {
namespace {

struct System {
  WalkSystemInfo info;
  std::unique_ptr<WalkSystem> (*make)(const BakedScene&, ChunkCache&, const WalkOptions&);
};
constexpr std::array systems = {
    System{{"everything", "all objects in full detail", true}, make_everything},
    System{{"frustum", "objects in the frustum, in full detail", true}, make_frustum_only},
    System{{"frustum-levels", "objects in the frustum, at the levels of the cell", true},
           make_frustum_and_levels},
    System{{"cell-lists", "the objects of the cell's row, at its levels", true}, make_cell_lists},
    System{{"vlod", "the same by differences between neighbouring cells [Chhugani et al. 2005, section 7]",
            true},
           make_vlod},
};

std::span<std::uint32_t> numbers(std::span<std::byte> memory) {
  return {reinterpret_cast<std::uint32_t*>(memory.data()), memory.size() / 4};
}

/// Reads a row into the front of `memory`; returns how many ids it has.
std::size_t read_row(const RowReader& reader, std::uint32_t row, std::span<std::uint32_t> memory) {
  thread_local RowBuffer<std::uint32_t> buffer;
  const auto ids = reader.ids(row, buffer);
  if (ids.size() > memory.size())
    throw FormatError("row " + std::to_string(row) + " has more columns than before");
  std::copy(ids.begin(), ids.end(), memory.begin());
  return ids.size();
}

/// What a row costs on disk. Where its bytes lie is not known from outside, as rows may share them: so each row has
/// pages of its own, and each is a read of its own.
struct RowPlaces {
  std::vector<std::uint64_t> offset, bytes;
  void add(std::uint64_t more) {
    constexpr std::uint64_t page = 4096;
    offset.push_back(offset.empty() ? 0 : offset.back() + (bytes.back() / page + 2) * page);
    bytes.push_back(more);
  }
};

/// The lists of each boundary: 4 bytes for each id of what appears, then of what vanishes.
ChunkSource lists_of(const BakedScene& scene) {
  const auto places = std::make_shared<RowPlaces>();
  const auto count = static_cast<std::uint32_t>(scene.boundaries().size());
  for (std::uint32_t b = 0; b < count; ++b) {
    places->add(scene.lists().cost(scene.row_of_list(2 * b)).bytes +
                scene.lists().cost(scene.row_of_list(2 * b + 1)).bytes);
  }
  return {count,
          [&scene, places](std::uint32_t b) {
            return ChunkPlace{
                places->offset[b], places->bytes[b],
                std::uint64_t{4} * (scene.columns_of_list(2 * b) + scene.columns_of_list(2 * b + 1))};
          },
          [&scene](std::uint32_t b, std::span<std::byte> memory) {
            const auto ids = numbers(memory);
            const std::size_t first = read_row(scene.lists(), scene.row_of_list(2 * b), ids);
            read_row(scene.lists(), scene.row_of_list(2 * b + 1), ids.subspan(first));
          }};
}

/// The row of each cell.
ChunkSource rows_of(const BakedScene& scene) {
  const auto places = std::make_shared<RowPlaces>();
  const std::uint32_t count = scene.file().cells.count();
  for (std::uint32_t cell = 0; cell < count; ++cell) {
    places->add(scene.rows().cost(scene.row_of_cell(cell)).bytes);
  }
  return {count,
          [&scene, places](std::uint32_t cell) {
            return ChunkPlace{places->offset[cell], places->bytes[cell],
                              std::uint64_t{4} * scene.columns_of_cell(cell)};
          },
          [&scene](std::uint32_t cell, std::span<std::byte> memory) {
            read_row(scene.rows(), scene.row_of_cell(cell), numbers(memory));
          }};
}

/// The scene's images at the versions of one cell, kept while the viewer is in it.
class References {
 public:
  explicit References(const BakedScene& scene) : scene_(scene) {}
  const ItemBuffer& of(std::vector<std::uint32_t> versions) {
    if (!buffer_ || versions != versions_) {
      buffer_.reset();
      buffer_.emplace(scene_.scene_of(versions), RayCaster::Preparation::soon);
      versions_ = std::move(versions);
    }
    return *buffer_;
  }
  std::span<const std::uint32_t> versions() const { return versions_; }

 private:
  const BakedScene& scene_;
  std::vector<std::uint32_t> versions_;
  std::optional<ItemBuffer> buffer_;
};

const System& system_named(const std::string& name) {
  std::string names;
  for (const System& system : systems) {
    if (system.info.name == name) return system;
    names += (names.empty() ? "" : ", ") + std::string(system.info.name);
  }
  throw std::invalid_argument("system '" + name + "' is none of " + names);
}

Nanoseconds nanoseconds(double value) {
  return static_cast<Nanoseconds>(std::llround(value));
}

/// A walk while it goes on.
class Replay {
 public:
  Replay(const BakedScene& scene, const WalkOptions& options, const OnImages& on_images)
      : scene_(scene),
        options_(options),
        on_images_(on_images),
        chunks_{scene},
        cache_({lists_of(scene), rows_of(scene), source_of(scene.geometry())}, options.disk,
               cache_options(options)),
        system_(system_named(options.system).make(scene, cache_, options)),
        finder_(scene.file().cells),
        references_(scene) {}

  void frame(const Pose& pose, Nanoseconds interval) {
    FrameRecord record;
    record.frame = static_cast<std::uint32_t>(walk_.frames.size());
    record.pose = pose;
    record.begins = now_;
    record.cell = finder_.find(pose.position, cell_);
    cell_ = record.cell;
    const ChunkCounters before = cache_.counters();
    cache_.advance(now_);
    overflow_.clear();

    const Frustum frustum(pose, options_.screen, options_.near);
    const std::function<void()> wait = [&] {
      if (options_.mode == WalkMode::deadline) return;
      const Nanoseconds from = cache_.now();
      record.stall += cache_.wait([&](std::uint32_t chunk, std::span<const std::byte> bytes) {
        std::vector<std::uint32_t>& ids = overflow_[chunk];
        if (chunks_.is_geometry(chunk)) return;
        ids.resize(bytes.size() / 4);
        if (!bytes.empty()) std::memcpy(ids.data(), bytes.data(), bytes.size());
      }) - from;
    };
    Frame frame{pose, frustum, record.cell, cache_, record, wait, overflow_, walk_.faults, {}};
    system_->make(frame);
    draw(frame);

    const ChunkCounters after = cache_.counters();
    record.requests = static_cast<std::uint32_t>(after.requests - before.requests);
    record.hits = static_cast<std::uint32_t>(after.hits - before.hits);
    record.reads = after.reads - before.reads;
    record.pages = after.pages - before.pages;
    record.bytes = after.bytes_read - before.bytes_read;
    record.prefetched = after.prefetched - before.prefetched;
    record.evicted = after.evicted - before.evicted;
    record.overflow = after.overflow_chunks - before.overflow_chunks;
    record.cached_bytes = cache_.bytes();
    tell_failures(record.frame);
    walk_.frames.push_back(record);
    now_ += std::max(interval, record.time());
  }

  Walk end() { return std::move(walk_); }

 private:
  static ChunkCacheOptions cache_options(const WalkOptions& options) {
    ChunkCacheOptions cache;
    cache.budget = options.cache_bytes;
    cache.seed = options.seed;
    const unsigned cores = std::max(1u, std::thread::hardware_concurrency());
    cache.threads = std::min(16u, options.threads == 0 ? cores : options.threads);
    return cache;
  }

  /// Culls, counts what is drawn, and makes the images.
  void draw(Frame& frame) {
    FrameRecord& record = frame.record;
    const std::span<const Version> versions = scene_.versions();
    record.versions = static_cast<std::uint32_t>(frame.versions.size());
    const bool culls = system_->culls();
    std::vector<std::uint32_t> drawn;
    for (std::size_t i = 0; i < frame.versions.size(); ++i) {
      const std::uint32_t version = frame.versions[i], chunk = chunks_.geometry(version);
      if (culls && !frame.frustum.meets(scene_.object_bounds()[versions[version].object])) continue;
      const ChunkCache::State state = cache_.state(chunk);
      if (state == ChunkCache::State::failed) {
        ++record.failed;
      } else if (state == ChunkCache::State::ready || overflow_.count(chunk) > 0) {
        ++record.drawn_objects;
        record.drawn_triangles += system_->triangles(frame, i);
        drawn.push_back(version);
      } else {
        ++record.late;
      }
    }
    record.culling = nanoseconds(options_.prices.culling_ns * static_cast<double>(frame.versions.size()));
    record.drawing =
        nanoseconds(1e9 * static_cast<double>(record.drawn_triangles) / options_.prices.triangles_per_second);
    if (options_.image_every == 0 || record.frame % options_.image_every != 0) return;
    try {
      make_images(record, drawn);
    } catch (const FormatError& error) {  // of a chunk that the reference needs
      frame.faults.push_back("frame " + std::to_string(record.frame) + ": no image: " + error.what());
    }
  }

  void make_images(FrameRecord& record, const std::vector<std::uint32_t>& drawn) {
    const ItemBuffer& buffer = references_.of(system_->reference(record.cell));
    const std::span<const std::uint32_t> shown = references_.versions();
    const ItemImage reference = buffer.draw(record.pose, options_.screen, options_.near, options_.threads);
    std::vector<std::uint8_t> is_drawn(shown.size());
    bool same_levels = true;
    for (const std::uint32_t version : drawn) {
      const std::uint32_t object = scene_.versions()[version].object;
      is_drawn[object] = 1;
      same_levels = same_levels && shown[object] == version;
    }
    ItemImage image;
    if (same_levels) {
      image = buffer.draw_only(is_drawn, reference, record.pose, options_.screen, options_.near,
                               options_.threads);
    } else {  // late: other levels than those of this cell are drawn
      image = ItemBuffer(scene_.scene_of(drawn), RayCaster::Preparation::soon)
                  .draw(record.pose, options_.screen, options_.near, options_.threads);
    }
    record.has_image = true;
    record.errors = errors_of(image, reference);
    if (on_images_) on_images_(record, image, reference);
  }

  void tell_failures(std::uint32_t frame) {
    if (cache_.counters().failed == told_) return;
    const auto failures = cache_.failures();
    for (; told_ < failures.size(); ++told_) {
      const auto& [chunk, message] = failures[told_];
      walk_.faults.push_back("frame " + std::to_string(frame) + ": " + chunks_.name(chunk) + " is left out" +
                             (message.empty() ? "" : ": " + message));
    }
  }

  const BakedScene& scene_;
  const WalkOptions& options_;
  const OnImages& on_images_;
  WalkChunks chunks_;
  ChunkCache cache_;
  std::unique_ptr<WalkSystem> system_;
  CellFinder finder_;
  References references_;
  std::map<std::uint32_t, std::vector<std::uint32_t>> overflow_;
  std::uint32_t cell_ = CellFinder::none;
  Nanoseconds now_ = 0;
  std::size_t told_ = 0;
  Walk walk_;
};

}  // namespace

std::string WalkChunks::name(std::uint32_t chunk) const {
  if (is_geometry(chunk)) {
    const Version& v = scene.versions()[version(chunk)];
    return "object " + std::to_string(v.object) + " at level " + std::to_string(v.level);
  }
  if (chunk >= boundaries()) return "the row of view cell " + std::to_string(chunk - boundaries());
  const Boundary& boundary = scene.boundaries()[chunk];
  return "the lists of the boundary between " + cell_name(boundary.from) + " and " + cell_name(boundary.to);
}

void WalkChunks::sort_for_disk(std::vector<std::uint32_t>& chunks) const {
  std::sort(chunks.begin(), chunks.end(), [&](std::uint32_t a, std::uint32_t b) {
    if (!is_geometry(a) || !is_geometry(b)) return a < b;
    return scene.geometry().offset(version(a)) < scene.geometry().offset(version(b));
  });
}

void Pins::become(std::span<const std::uint32_t> chunks) {
  more_.clear(), fewer_.clear();
  std::set_difference(chunks.begin(), chunks.end(), chunks_.begin(), chunks_.end(),
                      std::back_inserter(more_));
  std::set_difference(chunks_.begin(), chunks_.end(), chunks.begin(), chunks.end(),
                      std::back_inserter(fewer_));
  all_.sort_for_disk(more_);
  cache_.pin(more_);
  cache_.unpin(fewer_);
  chunks_.assign(chunks.begin(), chunks.end());
}

std::span<const WalkSystemInfo> walk_systems() {
  static const std::vector<WalkSystemInfo> all = [] {
    std::vector<WalkSystemInfo> list;
    for (const System& system : systems) list.push_back(system.info);
    return list;
  }();
  return all;
}

Walk walk(const BakedScene& scene, const CameraPath& path, const WalkOptions& options,
          const Progress& progress, const OnImages& on_images) {
  if (options.frames == 0) throw std::invalid_argument("a walk needs at least one frame");
  if (!(options.prices.triangles_per_second > 0))
    throw std::invalid_argument("triangles a second must be above 0");
  Replay replay(scene, options, on_images);
  const std::vector<Pose> poses = path.frames(options.frames);
  const Nanoseconds interval =
      poses.size() < 2
          ? 0
          : nanoseconds(1e9 * (path.end() - path.begin()) / static_cast<double>(poses.size() - 1));
  for (std::size_t i = 0; i < poses.size(); ++i) {
    replay.frame(poses[i], interval);
    if (progress) progress(i + 1, poses.size());
  }
  return replay.end();
}

}  // namespace vismat
