// What a viewer has in memory: a cache of chunks with a budget of bytes, and the queues of what it reads next.
#pragma once
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <memory_resource>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "runtime/storage/chunk_store.h"
#include "runtime/storage/read_threads.h"
#include "runtime/storage/virtual_disk.h"

namespace vismat {

/// Where a chunk lies in its file, and how many bytes it takes in memory once it is read.
struct ChunkPlace {
  std::uint64_t offset = 0, bytes = 0, memory = 0;
};

/// Chunks of one file. Both functions may be called by several threads at once.
struct ChunkSource {
  std::uint32_t count = 0;
  /// Of chunk i < count; always the same. Chunks may share bytes of the file. One without bytes and memory is always
  /// ready; one without bytes, but with memory, counts as one byte on disk.
  std::function<ChunkPlace(std::uint32_t)> place;
  /// Fills memory of place(i).memory bytes, aligned as std::max_align_t is, always with the same. Throws FormatError if
  /// what it reads is damaged, or another std::exception.
  std::function<void(std::uint32_t, std::span<std::byte>)> read;
};
/// The store is borrowed; a chunk takes in memory the bytes that it has on disk.
ChunkSource source_of(const ChunkStore& store);
ChunkSource source_of(ChunkStore&&) = delete;

/// What happens in a cache, in this order on its clock.
struct ChunkEvent {
  enum class Kind { read, ready, failed, evicted, dropped, overflow };
  Kind kind = Kind::read;
  Nanoseconds time = 0;
  std::uint32_t chunk = 0;   // of a read, its first
  std::uint64_t amount = 0;  // of a read, its pages; otherwise the chunk's bytes in memory
  bool operator==(const ChunkEvent&) const = default;
};

struct ChunkCacheOptions {
  std::uint64_t budget = 32 << 20;    // bytes; what counts is said at ChunkCache
  std::uint64_t seed = 1;             // of the disk's jitter
  std::uint64_t page_bytes = 4096;    // the disk reads whole pages
  std::uint64_t run_bytes = 1 << 20;  // the most that one read of several chunks takes from the disk
  unsigned threads = 1;  // 2 to 16: so many threads read while the clock runs; no result depends on it
  std::pmr::memory_resource* memory = nullptr;        // of the chunks and the table; null: new and delete
  std::function<void(const ChunkEvent&)> watch = {};  // must not call the cache
};

/// All of them add up from the start.
struct ChunkCounters {
  std::uint64_t requests = 0;                    // chunks given to pin()
  std::uint64_t hits = 0;                        // of these, ready
  std::uint64_t hits_in_flight = 0;              // of these, being read
  std::uint64_t reads = 0;                       // runs of pages: each begins with a seek
  std::uint64_t pages = 0;                       // read; a page counts once in a run
  std::uint64_t bytes_read = 0;                  // of these pages
  std::uint64_t bytes_wanted = 0;                // of the chunks in them that were asked for
  std::uint64_t evicted = 0, evicted_bytes = 0;  // chunks given up for others, and their bytes in memory
  std::uint64_t prefetched = 0;                  // chunks read because of prefetch()
  std::uint64_t prefetched_used = 0;             // of these, pinned before they were evicted
  std::uint64_t prefetch_dropped = 0;            // there was no room when their turn came
  std::uint64_t prefetch_replaced = 0;  // their turn had not come when the next prefetch() was called
  std::uint64_t overflow_chunks = 0,
                overflow_bytes = 0;  // read by wait() and dropped: chunks, and their bytes on disk
  Nanoseconds overflow_time = 0;     // that these reads took
  std::uint64_t failed = 0;
  std::uint64_t peak_bytes = 0;
  bool operator==(const ChunkCounters&) const = default;
};

/// Chunks of one or several sources on one virtual disk, numbered through: source s begins at first(s). After Chhugani
/// et al. 2005, section 7 (objects in view are locked, others go by least recent use) and Correa et al. 2003, section 4
/// (a prefetch queue that is served when nothing is fetched).
///
/// A channel that is free takes the first chunk of the fetch queue and with it all that follow it on disk in the same queue
/// without a gap of a whole page, up to run_bytes: one read. Memory is reserved when the read begins. If there is
/// none, ready chunks that are not pinned are evicted, those first that were unpinned or read the longest ago. A pinned
/// chunk for which that is not enough waits until memory is freed. Prefetches are served when no chunk is to be fetched
/// or waits.
///
/// The budget covers this object, its table of 32 bytes a chunk, the sources' list, 16 threads without their stacks, and the chunks'
/// memory as it is asked for from the allocator; not what the sources hold. It is never exceeded.
///
/// Nothing happens by itself: queues move in advance() and wait(), and what was called before at the same time is seen
/// as a whole. Deterministic: times, counters, events and evictions depend on the calls, the places and the seed, not
/// on the number of threads. One thread may call it at a time.
class ChunkCache {
 public:
  enum class State : std::uint8_t { absent, queued, reading, ready, failed };
  /// Is given a chunk's bytes, which are gone when it returns; it must not call the cache.
  using Handle = std::function<void(std::uint32_t chunk, std::span<const std::byte>)>;

  /// Throws std::invalid_argument as VirtualDisk does, if the page size is 0, for more than 16 threads, and if the budget
  /// is below the table and the largest chunk together. O(chunks log chunks).
  ChunkCache(std::vector<ChunkSource> sources, const DiskModel& disk, ChunkCacheOptions options = {});
  ~ChunkCache();
  ChunkCache(const ChunkCache&) = delete;
  ChunkCache& operator=(const ChunkCache&) = delete;

  std::uint32_t count() const { return static_cast<std::uint32_t>(records_.size()); }
  std::uint32_t first(std::size_t source) const { return first_[source]; }
  Nanoseconds now() const { return now_; }
  const ChunkCounters& counters() const { return counters_; }
  /// What is allocated now, as the budget counts it.
  std::uint64_t bytes() const { return used_; }
  State state(std::uint32_t chunk) const;
  /// Of a chunk that is ready, until the next call of unpin(), advance() or wait(), or, while it is pinned, the next wait().
  /// Throws std::logic_error if it is not ready.
  std::span<const std::byte> data(std::uint32_t chunk) const;
  /// The number of pinned chunks that are neither ready nor failed.
  std::uint32_t missing() const { return fetches_ + waiting_.count; }

  /// These are needed now: what is absent, or was to be prefetched, joins the end of the fetch queue. A chunk may be
  /// pinned several times, and is then unpinned as often. Give them in the order on disk, so that they are read in few
  /// runs. Throws std::logic_error for a chunk that does not exist. O(ids).
  void pin(std::span<const std::uint32_t> ids);
  /// Throws std::logic_error for a chunk that is not pinned. What was not yet being read is no longer read. O(ids).
  void unpin(std::span<const std::uint32_t> ids);
  /// These may be needed soon, the first of them first. Replaces what earlier calls asked for and was not yet being
  /// read. Does not touch when a chunk was last used. Evicts nothing that is pinned or in `ids`; what then has no
  /// room is dropped when its turn comes. O(ids).
  void prefetch(std::span<const std::uint32_t> ids);

  /// Runs the clock up to `time`. Throws std::logic_error if that is before now().
  void advance(Nanoseconds time);
  /// Runs the clock until every pinned chunk is ready or failed or, with nothing else being read, does not fit into
  /// memory. Those that do not are read one after another in the order on disk, handed over and dropped ("overflow"); they stay
  /// pinned, and the next wait() reads them again. So that the largest of them has room, chunks that are pinned and
  /// ready may be taken back, those with the highest numbers first; they are then handed over, too. Returns now().
  Nanoseconds wait(const Handle& handle = {});

  struct Failure {
    std::uint32_t chunk = 0;
    std::string message;  // of the first 16; at most 255 bytes
  };
  /// The chunks that could not be read, in the order in which this was found. They are not tried again.
  std::vector<Failure> failures() const;

 private:
  static constexpr std::uint32_t none = 0xffffffff;
  static constexpr unsigned most_threads = 16;
  enum class Stage : std::uint8_t { absent, fetch, waiting, prefetch, reading, ready, failed };
  struct Record {
    std::byte* memory = nullptr;
    std::uint32_t previous = none, next = none;  // in the one list in which it is
    std::uint32_t next_on_disk = none;           // in the same source
    std::uint32_t wish = 0;                      // the last call of prefetch() that named it
    std::uint32_t pins = 0;
    Stage stage = Stage::absent;
    bool by_prefetch = false;  // and not pinned since
    bool unread = false;       // a thread could not read it
  };
  static_assert(sizeof(Record) == 32);
  struct List {
    std::uint32_t head = none, tail = none, count = 0;
  };
  struct Flight {
    Nanoseconds completion = 0;
    std::uint64_t number = 0;  // of the read
    List run;                  // empty: the channel is free
  };
  struct Run {
    std::uint32_t source = 0;
    std::uint64_t begin = 0, end = 0;  // pages
  };

  std::uint32_t source_of_chunk(std::uint32_t chunk) const;
  ChunkPlace place(std::uint32_t chunk) const;
  void read(std::uint32_t chunk, std::span<std::byte> memory) const;
  bool is_empty(std::uint32_t chunk) const;
  Record& checked(std::uint32_t chunk);

  void push_back(List& list, std::uint32_t chunk);
  void unlink(List& list, std::uint32_t chunk);
  void sort_by_disk(List& list);
  bool before_on_disk(std::uint32_t a, std::uint32_t b) const;

  bool fits(std::uint64_t bytes, bool prefetch) const;
  std::byte* reserve(std::uint64_t bytes, bool prefetch);
  void release(std::byte* memory, std::uint64_t bytes);
  void evict(std::uint32_t chunk);
  void make_evictable(std::uint32_t chunk);
  void make_unevictable(std::uint32_t chunk);
  void count_as_used(Record& record);

  Run run_of(std::uint32_t chunk) const;
  bool extend(Run& run, std::uint32_t chunk) const;
  Nanoseconds begin_on_disk(const Run& run, std::uint32_t chunk);
  void dispatch();
  bool begin_read(List& queue, bool prefetch);
  void take(List& queue, std::uint32_t chunk, bool prefetch, Flight& flight);
  void read_flight(std::uint32_t channel);
  std::uint32_t next_channel() const;
  void step();
  void complete(std::uint32_t chunk, bool read_already);
  void fail(std::uint32_t chunk, std::string_view message);
  void overflow(const Handle& handle);
  void make_room_for_overflow();
  void hand_over(std::uint32_t chunk, const Handle& handle);
  void tell(ChunkEvent::Kind kind, std::uint32_t chunk, std::uint64_t amount) const;

  std::vector<ChunkSource> sources_;
  std::vector<std::uint32_t> first_;  // and the number of chunks
  VirtualDisk disk_;
  ChunkCacheOptions options_;
  std::pmr::vector<Record> records_;
  std::pmr::vector<Flight> flights_;  // for each channel
  List fetch_, waiting_, prefetch_, unused_ /* evictable, the least recently used first */, failed_;
  std::uint32_t cursor_ = none;  // in unused_: all before it are in the last prefetch()
  std::uint32_t wish_ = 1;       // the number of the last prefetch(), 1 before the first
  std::uint32_t fetches_ = 0;    // pinned chunks that are in the fetch queue or being read
  std::uint32_t in_flight_ = 0;
  bool retry_ = false;  // memory was freed: those that wait may fit
  Nanoseconds now_ = 0;
  std::uint64_t used_ = 0, evictable_ = 0, wished_ = 0 /* evictable and in the last prefetch() */;
  ChunkCounters counters_;
  std::uint32_t messages_kept_ = 0;
  std::array<std::array<char, 256>, 16> messages_;  // of the first failures
  std::atomic<bool> stop_ = false;
  std::unique_ptr<ReadThreads> threads_;  // last: its threads end before what they read goes
};

}  // namespace vismat
