// Lays objects out on a disk, and counts what a viewer must read of it to fetch those that come into view.
#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "matrix/permutation.h"
#include "matrix/visibility_matrix.h"

namespace vismat {

/// Objects one after another without gaps, object o at place order.new_of_old()[o]. Sizes in bytes; 0 is one.
class DiskLayout {
 public:
  /// Throws std::invalid_argument unless there is a size for each object of the order and their sum is below 2^64.
  DiskLayout(std::vector<std::uint64_t> bytes_of_object, const Permutation& order);

  std::uint32_t objects() const { return static_cast<std::uint32_t>(bytes_.size()); }
  std::uint64_t offset(std::uint32_t object) const { return offset_[object]; }
  std::uint64_t bytes(std::uint32_t object) const { return bytes_[object]; }
  std::uint64_t total_bytes() const { return total_; }

 private:
  std::vector<std::uint64_t> bytes_, offset_;
  std::uint64_t total_ = 0;
};

struct DiskOptions {
  std::uint64_t page_bytes = 4096;  // what the disk reads, it reads in whole pages
  /// A read goes on over up to so many unwanted pages to the next wanted one.
  std::uint64_t read_ahead_pages = 0;
  /// What memory keeps between fetches: nothing if not given; else the objects now in view, whatever they take,
  /// and of the others the last seen ones, as long as all together take no more than this.
  std::optional<std::uint64_t> cache_bytes = {};
};

struct DiskReads {
  std::uint64_t reads = 0;         // each begins with a seek
  std::uint64_t bytes_read = 0;    // whole pages, the unwanted ones that were read over included
  std::uint64_t bytes_wanted = 0;  // of the objects that were not in memory
  bool operator==(const DiskReads&) const = default;
};

/// A viewer comes through the rows of `walk`, one after another, and fetches in each what the row lists and memory
/// lacks [Chhugani et al. 2005, 6.1 and 7]. Within a fetch pages are read in ascending order, none twice; nothing
/// read is kept but the objects asked for. With page_bytes = 1, objects of 1 byte and neither read-ahead nor cache,
/// reads are runs of ones (count_runs). Counts, no times: a seek costs what it costs on the disk at hand.
/// Deterministic. O(ones of the rows walked * log). Throws std::invalid_argument for a row or page size that is none
/// and for a matrix of other columns than the layout has objects.
DiskReads count_disk_reads(const DiskLayout& layout, const VisibilityMatrix& visible,
                           std::span<const std::uint32_t> walk, const DiskOptions& options = {});

}  // namespace vismat
