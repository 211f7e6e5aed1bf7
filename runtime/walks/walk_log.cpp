#include "runtime/walks/walk_log.h"

#include <algorithm>
#include <cinttypes>
#include <cstdio>

namespace vismat {
namespace {

double milliseconds(Nanoseconds time) {
  return static_cast<double>(time) / 1e6;
}

/// The value that `share` of the values do not exceed.
template <typename Value>
Value quantile(std::vector<Value> values, double share) {
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  const auto at = static_cast<std::size_t>(share * static_cast<double>(values.size()));
  return values[std::min(at, values.size() - 1)];
}

}  // namespace

std::string to_csv(std::span<const FrameRecord> frames) {
  std::string text =
      "frame,t,x,y,z,qx,qy,qz,qw,begins_ms,cell,crossed,jumped,versions,requests,hits,reads,pages,bytes,"
      "prefetched,evicted,overflow,failed,late,cached_bytes,drawn_objects,drawn_triangles,culling_us,"
      "decoding_us,"
      "drawing_ms,stall_ms,missing,wrong,extra\n";
  char line[900];
  for (const FrameRecord& f : frames) {
    const glm::dvec3& at = f.pose.position;
    const glm::dquat& q = f.pose.rotation;
    std::snprintf(line, sizeof line,
                  "%" PRIu32 ",%.6f,%.6f,%.6f,%.6f,%.9f,%.9f,%.9f,%.9f,%.6f,%s,%" PRIu32 ",%d,%" PRIu32
                  ",%" PRIu32 ",%" PRIu32 ",%" PRIu64 ",%" PRIu64 ",%" PRIu64 ",%" PRIu64 ",%" PRIu64
                  ",%" PRIu64 ",%" PRIu64 ",%" PRIu64 ",%" PRIu64 ",%" PRIu32 ",%" PRIu64
                  ",%.3f,%.3f,%.6f,%.6f,",
                  f.frame, f.pose.time, at.x, at.y, at.z, q.x, q.y, q.z, q.w, milliseconds(f.begins),
                  f.cell == FrameRecord::no_cell ? "no cell" : std::to_string(f.cell).c_str(), f.crossed,
                  f.jumped ? 1 : 0, f.versions, f.requests, f.hits, f.reads, f.pages, f.bytes, f.prefetched,
                  f.evicted, f.overflow, f.failed, f.late, f.cached_bytes, f.drawn_objects, f.drawn_triangles,
                  1e3 * milliseconds(f.culling), 1e3 * milliseconds(f.decoding), milliseconds(f.drawing),
                  milliseconds(f.stall));
    text += line;
    if (f.has_image) {
      std::snprintf(line, sizeof line, "%" PRIu64 ",%" PRIu64 ",%" PRIu64 "\n", f.errors.missing,
                    f.errors.wrong, f.errors.extra);
      text += line;
    } else {
      text += ",,\n";
    }
  }
  return text;
}

WalkSummary summary_of(std::span<const FrameRecord> frames, const Screen& screen) {
  WalkSummary sum;
  std::vector<double> stalls;
  std::vector<std::uint64_t> wrong;
  double time = 0, time_squared = 0, triangles = 0, objects = 0, versions = 0;
  bool after_first_cell = false;
  std::uint32_t first_cell = FrameRecord::no_cell;
  for (const FrameRecord& f : frames) {
    if (f.cell == FrameRecord::no_cell) {
      ++sum.frames_without_cell;
      continue;
    }
    if (first_cell == FrameRecord::no_cell) first_cell = f.cell;
    after_first_cell = after_first_cell || f.cell != first_cell;
    ++sum.frames;
    sum.crossings += f.crossed;
    sum.jumps += f.jumped;
    sum.requests += f.requests, sum.hits += f.hits;
    sum.reads += f.reads, sum.pages += f.pages, sum.bytes += f.bytes;
    sum.prefetched += f.prefetched, sum.evicted += f.evicted, sum.overflow += f.overflow;
    sum.failed += f.failed, sum.late += f.late;
    sum.most_cached_bytes = std::max(sum.most_cached_bytes, f.cached_bytes);
    sum.stalled_frames += f.stall > 0;
    sum.stalled_frames_after_the_first_cell += f.stall > 0 && after_first_cell;
    stalls.push_back(milliseconds(f.stall));
    sum.stall_ms += stalls.back();
    sum.worst_stall_ms = std::max(sum.worst_stall_ms, stalls.back());
    const double ms = milliseconds(f.time());
    time += ms, time_squared += ms * ms;
    sum.worst_frame_ms = std::max(sum.worst_frame_ms, ms);
    triangles += static_cast<double>(f.drawn_triangles);
    objects += f.drawn_objects;
    versions += f.versions;
    if (f.has_image) {
      ++sum.images;
      sum.pixels += std::uint64_t{screen.width} * screen.height;
      sum.errors.missing += f.errors.missing;
      sum.errors.wrong += f.errors.wrong;
      sum.errors.extra += f.errors.extra;
      wrong.push_back(f.errors.all());
      sum.worst_image = std::max(sum.worst_image, wrong.back());
    }
  }
  if (!frames.empty()) {
    sum.seconds = milliseconds(frames.back().begins + frames.back().time() - frames.front().begins) / 1e3;
  }
  const double count = std::max<double>(1, static_cast<double>(sum.frames));
  sum.p99_stall_ms = quantile(stalls, .99);
  sum.p95_image = static_cast<double>(quantile(wrong, .95));
  sum.mean_frame_ms = time / count;
  sum.frame_ms_variance = std::max(0.0, time_squared / count - sum.mean_frame_ms * sum.mean_frame_ms);
  sum.mean_triangles = triangles / count;
  sum.mean_objects = objects / count;
  sum.mean_versions = versions / count;
  return sum;
}

}  // namespace vismat
