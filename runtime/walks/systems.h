// What a run-time system is: it decides, pose by pose, what is asked for and drawn. Internal to this room.
#pragma once
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "runtime/camera/frustum.h"
#include "runtime/storage/chunk_cache.h"
#include "runtime/walks/baked_scene.h"
#include "runtime/walks/walk.h"

namespace vismat {

/// The chunks of a walk, as its cache numbers them: lists first, because a cache that is too small gives up chunks of
/// high numbers first, and no geometry is of use without them.
struct WalkChunks {
  const BakedScene& scene;
  std::uint32_t lists(std::uint32_t boundary) const { return boundary; }
  std::uint32_t row(std::uint32_t cell) const { return boundaries() + cell; }
  std::uint32_t geometry(std::uint32_t version) const { return boundaries() + cells() + version; }
  bool is_geometry(std::uint32_t chunk) const { return chunk >= geometry(0); }
  std::uint32_t version(std::uint32_t chunk) const { return chunk - geometry(0); }
  std::uint32_t boundaries() const { return static_cast<std::uint32_t>(scene.boundaries().size()); }
  std::uint32_t cells() const { return scene.file().cells.count(); }
  /// Sorts chunks for the disk: lists and rows, then geometry in the order of the store.
  void sort_for_disk(std::vector<std::uint32_t>& chunks) const;
  /// How messages name it.
  std::string name(std::uint32_t chunk) const;
};

/// Keeps a set of chunks pinned.
class Pins {
 public:
  Pins(const WalkChunks& chunks, ChunkCache& cache) : all_(chunks), cache_(cache) {}
  /// From now on these are pinned, ascending and each once, and no others.
  void become(std::span<const std::uint32_t> chunks);
  std::span<const std::uint32_t> chunks() const { return chunks_; }

 private:
  WalkChunks all_;
  ChunkCache& cache_;
  std::vector<std::uint32_t> chunks_, more_, fewer_;
};

/// A frame while it is made.
struct Frame {
  const Pose& pose;
  const Frustum& frustum;
  std::uint32_t cell;  // that holds the viewer, or FrameRecord::no_cell
  ChunkCache& cache;
  FrameRecord& record;  // its costs, crossings and counts
  /// Waits in mode `wait` until all that is pinned is there; in mode `deadline` it does nothing.
  const std::function<void()>& wait;
  /// What the cache had no room for in the last wait: the ids of such a list or row, and whether such geometry was read.
  const std::map<std::uint32_t, std::vector<std::uint32_t>>& overflow;
  std::vector<std::string>& faults;  // Walk::faults
  /// The versions that belong to this place, ascending: what is drawn of them is for the frustum and the cache to say.
  std::vector<std::uint32_t> versions;
};

class WalkSystem {
 public:
  virtual ~WalkSystem() = default;
  /// Pins what the frame needs, waits for it, and fills frame.versions and the record's decoding time.
  virtual void make(Frame& frame) = 0;
  /// For each object the version that the reference image shows, for a viewer in the cell or in none.
  virtual std::vector<std::uint32_t> reference(std::uint32_t cell) const = 0;
  /// Whether only what the frustum meets is drawn.
  virtual bool culls() const { return true; }
  /// The number of the triangles of frame.versions[i] that are drawn; those of the version, unless it knows better.
  virtual std::uint32_t triangles(const Frame& frame, std::size_t i) const = 0;
};

/// The makers of the systems that walk_systems() lists.
std::unique_ptr<WalkSystem> make_everything(const BakedScene&, ChunkCache&, const WalkOptions&);
std::unique_ptr<WalkSystem> make_frustum_only(const BakedScene&, ChunkCache&, const WalkOptions&);
std::unique_ptr<WalkSystem> make_frustum_and_levels(const BakedScene&, ChunkCache&, const WalkOptions&);
std::unique_ptr<WalkSystem> make_cell_lists(const BakedScene&, ChunkCache&, const WalkOptions&);
std::unique_ptr<WalkSystem> make_vlod(const BakedScene&, ChunkCache&, const WalkOptions&);

}  // namespace vismat
