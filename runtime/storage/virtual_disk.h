// A virtual clock and a disk on it: how long reads take is computed, never measured, so that a walk gives the same log on every
// machine.
#pragma once
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace vismat {

/// A time on the virtual clock, or a length of time.
using Nanoseconds = std::int64_t;

/// A read takes one of the channels for latency + jitter + bytes / bytes_per_second, where the jitter is uniform in
/// [-jitter, +jitter] and at most the latency. Channels do not slow one another down: bytes_per_second is that of one
/// channel, and the disk as a whole gives `channels` times as much to large reads side by side.
struct DiskModel {
  std::string_view name;
  Nanoseconds latency = 0, jitter = 0;
  double bytes_per_second = 0;
  unsigned channels = 1;
  std::string_view source;  // where the figures are from, what was rounded, and what is our choice
};

/// disk-2004, sata-ssd, nvme, network.
std::span<const DiskModel> disk_models();
/// The model of that name. Throws std::invalid_argument, which lists the names, if there is none.
const DiskModel& disk_model(std::string_view name);
/// A model's name, or "latency_ms,MB_per_s,channels" or "latency_ms,MB_per_s,channels,jitter_ms", such as
/// "0.1,135,4", for one that is called `custom`. A MB is 10^6 bytes; MB_per_s is that of one channel. Throws
/// std::invalid_argument, which says what may be written, for anything else.
DiskModel parse_disk_model(std::string_view text);

/// The schedule of a disk's channels. Deterministic: the jitter of the n-th read depends on the seed and on n alone.
class VirtualDisk {
 public:
  /// Throws std::invalid_argument unless the model has 1 to 256 channels, a speed from 1 byte/s to 10^12 bytes/s, and
  /// 0 <= jitter <= latency <= 60 s.
  VirtualDisk(const DiskModel& model, std::uint64_t seed);

  /// When the first channel is free.
  Nanoseconds free_at() const;
  /// Gives the read to the channel that is free first (of these, the one with the lowest number), from `now` on or from when it
  /// is free. Returns when the bytes are there. O(channels).
  Nanoseconds begin(Nanoseconds now, std::uint64_t bytes);
  std::uint64_t reads() const { return reads_; }
  unsigned channels() const { return static_cast<unsigned>(free_.size()); }

 private:
  Nanoseconds latency_, jitter_;
  double bytes_per_second_;
  std::uint64_t seed_, reads_ = 0;
  std::vector<Nanoseconds> free_;  // for each channel
};

}  // namespace vismat
