// What a walk did, frame by frame, and in all.
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "runtime/camera/camera_path.h"
#include "runtime/images/item_buffer.h"
#include "runtime/storage/virtual_disk.h"

namespace vismat {

/// One frame. Counts are of this frame alone.
struct FrameRecord {
  static constexpr std::uint32_t no_cell = 0xffffffff;
  std::uint32_t frame = 0;
  Pose pose;
  Nanoseconds begins = 0;        // on the virtual clock
  std::uint32_t cell = no_cell;  // that holds the viewer
  std::uint32_t crossed = 0;     // boundaries between this cell and the last frame's
  bool jumped = false;           // the cell was loaded whole
  std::uint32_t versions = 0;    // objects of the cell, at their levels, whether in the frustum or not
  std::uint32_t requests = 0, hits = 0;  // chunks asked for, and those that were in memory
  std::uint64_t reads = 0, pages = 0,
                bytes = 0;         // from the disk, prefetches included; a read is a run of pages
  std::uint64_t prefetched = 0;    // chunks that a prefetch brought
  std::uint64_t evicted = 0;       // chunks
  std::uint64_t overflow = 0;      // chunks that the budget has no room for: read, drawn, dropped
  std::uint64_t failed = 0;        // chunks of this frame that are missing, cut or corrupt
  std::uint64_t late = 0;          // chunks of this frame that were not there in time; 0 where frames wait
  std::uint64_t cached_bytes = 0;  // what the cache takes at the frame's end
  std::uint32_t drawn_objects = 0;
  std::uint64_t drawn_triangles = 0;
  Nanoseconds culling = 0, decoding = 0, drawing = 0, stall = 0;  // what the frame's time is made of
  bool has_image = false;
  ImageErrors errors;  // against all objects at the same levels, if there is an image
  Nanoseconds time() const { return culling + decoding + drawing + stall; }
};

/// A line for each frame, with a line of names before them.
std::string to_csv(std::span<const FrameRecord> frames);

/// Sums, means and the worst of the frames that lie in a view cell; those in none are counted apart.
struct WalkSummary {
  std::uint64_t frames = 0, frames_without_cell = 0, crossings = 0, jumps = 0;
  std::uint64_t requests = 0, hits = 0, reads = 0, pages = 0, bytes = 0, prefetched = 0, evicted = 0,
                overflow = 0, failed = 0, late = 0, most_cached_bytes = 0;
  std::uint64_t stalled_frames = 0, stalled_frames_after_the_first_cell = 0;
  double seconds = 0;                                         // of the virtual clock
  double stall_ms = 0, p99_stall_ms = 0, worst_stall_ms = 0;  // the p99 is over all frames
  double mean_frame_ms = 0, frame_ms_variance = 0, worst_frame_ms = 0;
  double mean_triangles = 0, mean_objects = 0, mean_versions = 0;
  std::uint64_t images = 0, pixels = 0;
  ImageErrors errors;             // sums over the images
  std::uint64_t worst_image = 0;  // most wrong pixels in one
  double p95_image = 0;           // wrong pixels
};
WalkSummary summary_of(std::span<const FrameRecord> frames, const Screen& screen);

}  // namespace vismat
