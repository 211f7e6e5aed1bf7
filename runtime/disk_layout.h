// Where objects lie on a disk, and what a viewer must read from it to fetch the objects that come into view.
#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "matrix/permutation.h"
#include "matrix/visibility_matrix.h"

namespace vismat {

/// Places objects one after another without gaps, object o at place order.new_of_old()[o]. Sizes are in bytes and may
/// be 0.
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
  std::uint64_t page_bytes = 4096;  // the disk reads whole pages
  /// A read continues over up to this many unwanted pages to the next wanted one.
  std::uint64_t read_ahead_pages = 0;
  /// What memory keeps between fetches. Without a number: nothing. Otherwise: the objects that are in view, however
  /// large, and of the others those that were seen last, as long as all together take no more than this.
  std::optional<std::uint64_t> cache_bytes = {};
};

struct DiskReads {
  std::uint64_t reads = 0;         // each begins with a seek
  std::uint64_t bytes_read = 0;    // whole pages, with the unwanted ones that were read over
  std::uint64_t bytes_wanted = 0;  // of the objects that were not in memory
  bool operator==(const DiskReads&) const = default;
};

/// Walks through the rows of `walk`, one after another, and reads, at each, the listed objects that are not in memory
/// [Chhugani et al. 2005, sections 6.1 and 7]. Within a fetch, pages are read in ascending order and none is read
/// twice; nothing that is read is kept but the wanted objects. With page_bytes = 1, objects of 1 byte and neither
/// read-ahead nor cache, the reads are the runs of ones (count_runs). Reads are counted, not timed: the time of a seek
/// depends on the disk. Deterministic. O(ones of the rows walked * log). Throws std::invalid_argument for a row that
/// does not exist, a page size of 0, and a matrix whose columns are not as many as the layout's objects.
DiskReads count_disk_reads(const DiskLayout& layout, const VisibilityMatrix& visible,
                           std::span<const std::uint32_t> walk, const DiskOptions& options = {});

}  // namespace vismat
