// ALGORITHM. The objects to fetch, sorted by where they begin, are intervals of pages in ascending order; a read grows
// while the next interval begins within its reach. Memory is the paper's: what is in view is locked, what leaves it waits
// in a queue. As all that leaves does so at the same step, the queue is in order of last use; an entry is stale if its
// object was seen again since.
#include "runtime/disk_layout.h"

#include <algorithm>
#include <deque>
#include <iterator>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

namespace vismat {
namespace {

class Memory {
 public:
  Memory(const DiskLayout& layout, std::uint64_t limit)
      : layout_(layout), limit_(limit), seen_(layout.objects(), never) {}

  // Brings `view` into memory and returns what was not there, ascending.
  std::vector<std::uint32_t> look_at(std::span<const std::uint32_t> view) {
    std::vector<std::uint32_t> fetched, left;
    std::ranges::set_difference(last_view_, view, std::back_inserter(left));
    for (const std::uint32_t o : left) leaving_.emplace_back(step_, o);
    ++step_;
    for (const std::uint32_t o : view) {
      if (seen_[o] == never) {
        fetched.push_back(o);
        held_ += layout_.bytes(o);
      }
      seen_[o] = step_;
    }
    for (; held_ > limit_ && !leaving_.empty(); leaving_.pop_front()) {
      const auto [step, object] = leaving_.front();
      if (seen_[object] != step) continue;
      seen_[object] = never;
      held_ -= layout_.bytes(object);
    }
    last_view_ = view;
    return fetched;
  }

 private:
  static constexpr std::uint64_t never = 0;
  const DiskLayout& layout_;
  std::uint64_t limit_, held_ = 0, step_ = 0;
  std::vector<std::uint64_t> seen_;  // the step an object in memory was last in view
  std::span<const std::uint32_t> last_view_;
  std::deque<std::pair<std::uint64_t, std::uint32_t>> leaving_;  // last step in view, object
};

void fetch(const DiskLayout& layout, std::vector<std::uint32_t>& objects, const DiskOptions& options,
           DiskReads& count) {
  std::ranges::sort(objects, {}, [&](std::uint32_t o) { return layout.offset(o); });
  bool reading = false;
  std::uint64_t end = 0;  // the page after the last one read
  for (const std::uint32_t o : objects) {
    if (layout.bytes(o) == 0) continue;
    count.bytes_wanted += layout.bytes(o);
    const std::uint64_t first = layout.offset(o) / options.page_bytes;
    const std::uint64_t after = (layout.offset(o) + layout.bytes(o) - 1) / options.page_bytes + 1;
    const bool goes_on = reading && (first <= end || first - end <= options.read_ahead_pages);
    count.reads += !goes_on;
    count.bytes_read += (after - (goes_on ? end : first)) * options.page_bytes;
    end = after;
    reading = true;
  }
}

}  // namespace

DiskLayout::DiskLayout(std::vector<std::uint64_t> bytes_of_object, const Permutation& order)
    : bytes_(std::move(bytes_of_object)), offset_(bytes_.size()) {
  if (order.size() != bytes_.size()) {
    throw std::invalid_argument("a disk layout needs a size for each of the order's " +
                                std::to_string(order.size()) + " objects; there are " +
                                std::to_string(bytes_.size()));
  }
  for (const std::uint32_t o : order.old_of_new()) {
    offset_[o] = total_;
    if (bytes_[o] > std::numeric_limits<std::uint64_t>::max() - total_)
      throw std::invalid_argument("the objects of a disk layout take 2^64 bytes or more");
    total_ += bytes_[o];
  }
}

DiskReads count_disk_reads(const DiskLayout& layout, const VisibilityMatrix& visible,
                           std::span<const std::uint32_t> walk, const DiskOptions& options) {
  if (visible.shape().columns != layout.objects()) {
    throw std::invalid_argument("a matrix of " + std::to_string(visible.shape().columns) +
                                " columns does not go with a disk layout of " +
                                std::to_string(layout.objects()) + " objects");
  }
  if (options.page_bytes == 0) throw std::invalid_argument("a page has at least 1 byte");
  DiskReads count;
  Memory memory(layout, options.cache_bytes.value_or(0));
  for (const std::uint32_t r : walk) {
    if (r >= visible.shape().rows) {
      throw std::invalid_argument("a walk through row " + std::to_string(r) + " of a matrix of " +
                                  std::to_string(visible.shape().rows) + " rows");
    }
    const auto row = visible.row(r);
    std::vector<std::uint32_t> objects =
        options.cache_bytes ? memory.look_at(row) : std::vector(row.begin(), row.end());
    fetch(layout, objects, options, count);
  }
  return count;
}

}  // namespace vismat
