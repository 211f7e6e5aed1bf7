// A cache of chunks that keeps no bytes: everything it wants to know it looks for from end to end. The fast one is judged by it.
#pragma once
#include <algorithm>
#include <cstdint>
#include <set>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "runtime/storage/chunk_cache.h"

namespace vismat::test {

struct SlowChunk {
  std::uint32_t source = 0;
  ChunkPlace place;
  bool damaged = false;
  std::string state = "absent";  // fetch, waiting, prefetch, reading, ready, failed
  std::uint32_t pins = 0;
  bool by_prefetch = false;
};

class SlowCache {
 public:
  using Ids = std::vector<std::uint32_t>;

  SlowCache(std::vector<SlowChunk> all, const DiskModel& disk, const ChunkCacheOptions& how,
            std::uint64_t table)
      : chunks(std::move(all)), disk_(disk, how.seed), options_(how), table_(table) {
    counters.peak_bytes = table;
    for (SlowChunk& chunk : chunks) {
      if (is_empty(chunk)) chunk.state = "ready";
    }
  }

  void pin(const Ids& ids) {
    for (const std::uint32_t id : ids) {
      SlowChunk& chunk = chunks[id];
      ++counters.requests;
      counters.hits += chunk.state == "ready";
      counters.hits_in_flight += chunk.state == "reading";
      if (chunk.state == "ready" || chunk.state == "reading") use(chunk);
      if (chunk.state == "absent" || chunk.state == "prefetch") {
        std::erase(prefetch_, id);
        fetch_.push_back(id);
        chunk.state = "fetch";
      }
      std::erase(unused_, id);
      ++chunk.pins;
    }
  }
  void unpin(const Ids& ids) {
    for (const std::uint32_t id : ids) {
      SlowChunk& chunk = chunks[id];
      if (--chunk.pins > 0) continue;
      if (chunk.state == "ready" && !is_empty(chunk)) {
        unused_.push_back(id);
        freed_ = true;
      }
      if (chunk.state == "fetch" || chunk.state == "waiting") {
        std::erase(fetch_, id);
        std::erase(waiting_, id);
        chunk.state = "absent";
      }
    }
  }
  void prefetch(const Ids& ids) {
    counters.prefetch_replaced += prefetch_.size();
    for (const std::uint32_t id : prefetch_) chunks[id].state = "absent";
    prefetch_.clear();
    wished_ = std::set(ids.begin(), ids.end());
    for (const std::uint32_t id : ids) {
      if (chunks[id].state != "absent") continue;
      chunks[id].state = "prefetch";
      prefetch_.push_back(id);
    }
  }
  void advance(Nanoseconds time) {
    dispatch();
    while (!flights_.empty() && next()->completion <= time) {
      step();
      dispatch();
    }
    now = time;
  }
  void wait() {
    dispatch();
    while (!fetch_.empty() || fetching() || (!waiting_.empty() && !flights_.empty())) {
      step();
      dispatch();
    }
    if (!waiting_.empty()) overflow();
  }

  std::uint32_t missing() const {
    return static_cast<std::uint32_t>(std::ranges::count_if(chunks, [](const SlowChunk& chunk) {
      return chunk.pins > 0 && chunk.state != "ready" && chunk.state != "failed";
    }));
  }
  std::uint64_t used() const {
    std::uint64_t sum = table_;
    for (const SlowChunk& chunk : chunks)
      sum += chunk.state == "ready" || chunk.state == "reading" ? chunk.place.memory : 0;
    return sum;
  }

  std::vector<SlowChunk> chunks;
  Nanoseconds now = 0;
  ChunkCounters counters;
  std::vector<ChunkEvent> events;
  Ids handed;  // by the last wait()

 private:
  using Kind = ChunkEvent::Kind;
  struct Flight {
    Nanoseconds completion;
    std::uint64_t number;
    Ids run;
  };

  static bool is_empty(const SlowChunk& chunk) { return chunk.place.bytes == 0 && chunk.place.memory == 0; }
  std::uint64_t first_page(std::uint32_t id) const { return chunks[id].place.offset / options_.page_bytes; }
  std::uint64_t last_page(std::uint32_t id) const {
    const ChunkPlace& place = chunks[id].place;
    return (place.bytes == 0 ? place.offset : place.offset + place.bytes - 1) / options_.page_bytes;
  }
  Ids on_disk(Ids ids) const {
    std::ranges::sort(ids, {}, [this](std::uint32_t id) {
      return std::tuple(chunks[id].source, chunks[id].place.offset, id);
    });
    return ids;
  }
  void use(SlowChunk& chunk) {
    counters.prefetched_used += chunk.by_prefetch;
    chunk.by_prefetch = false;
  }
  bool fetching() const {
    return std::ranges::any_of(
        chunks, [](const SlowChunk& chunk) { return chunk.pins > 0 && chunk.state == "reading"; });
  }
  bool may_evict(std::uint32_t id, bool prefetch) const { return !prefetch || !wished_.contains(id); }
  bool room(std::uint64_t bytes, bool prefetch) const {
    std::uint64_t sum = used() + bytes;
    for (const std::uint32_t id : unused_) sum -= may_evict(id, prefetch) ? chunks[id].place.memory : 0;
    return sum <= options_.budget;
  }
  void give_up(std::uint32_t id, const char* state) {
    chunks[id].state = state;
    chunks[id].by_prefetch = false;
    ++counters.evicted;
    counters.evicted_bytes += chunks[id].place.memory;
    events.push_back({Kind::evicted, now, id, chunks[id].place.memory});
  }
  void make_room(std::uint64_t bytes, bool prefetch) {
    while (used() + bytes > options_.budget) {
      const auto oldest =
          std::ranges::find_if(unused_, [&](std::uint32_t id) { return may_evict(id, prefetch); });
      const std::uint32_t id = *oldest;
      unused_.erase(oldest);
      give_up(id, "absent");
    }
    counters.peak_bytes = std::max(counters.peak_bytes, used() + bytes);
  }
  // How many of the chunks, which are in order on disk, are one read, and its pages.
  std::pair<std::size_t, std::uint64_t> run_of(const Ids& ids) const {
    std::uint64_t end = last_page(ids[0]);
    std::size_t count = 1;
    for (; count < ids.size() && chunks[ids[count]].source == chunks[ids[0]].source; ++count) {
      if (first_page(ids[count]) > end + 1) break;
      const std::uint64_t longer = std::max(end, last_page(ids[count]));
      if ((longer - first_page(ids[0]) + 1) * options_.page_bytes > options_.run_bytes) break;
      end = longer;
    }
    return {count, end - first_page(ids[0]) + 1};
  }
  Nanoseconds read(std::uint32_t first, std::uint64_t pages) {
    ++counters.reads;
    counters.pages += pages;
    counters.bytes_read += pages * options_.page_bytes;
    events.push_back({Kind::read, now, first, pages});
    return disk_.begin(now, pages * options_.page_bytes);
  }
  void dispatch() {
    while (flights_.size() < disk_.channels()) {
      if (freed_) {
        for (const std::uint32_t id : waiting_) chunks[id].state = "fetch";
        fetch_.insert(fetch_.begin(), waiting_.begin(), waiting_.end());
        waiting_.clear();
      }
      freed_ = false;
      if (!fetch_.empty()) {
        begin(fetch_, false);
      } else if (waiting_.empty() && !prefetch_.empty()) {
        begin(prefetch_, true);
      } else {
        return;
      }
    }
  }
  void begin(Ids& queue, bool prefetch) {
    const std::uint32_t first = queue[0];
    if (!room(chunks[first].place.memory, prefetch)) {
      queue.erase(queue.begin());
      if (prefetch) {
        chunks[first].state = "absent";
        ++counters.prefetch_dropped;
        events.push_back({Kind::dropped, now, first, chunks[first].place.memory});
      } else {
        chunks[first].state = "waiting";
        waiting_.push_back(first);
      }
      return;
    }
    const Ids sorted = on_disk(queue);
    const Ids candidates(std::ranges::find(sorted, first), sorted.end());
    Ids run;
    for (const std::uint32_t id : candidates) {
      Ids longer = run;
      longer.push_back(id);
      if (run_of(longer).first < longer.size() || !room(chunks[id].place.memory, prefetch)) break;
      make_room(chunks[id].place.memory, prefetch);
      std::erase(queue, id);
      chunks[id].state = "reading";
      chunks[id].by_prefetch = prefetch;
      counters.prefetched += prefetch;
      counters.bytes_wanted += chunks[id].place.bytes;
      run = longer;
    }
    const std::uint64_t number = disk_.reads();
    flights_.push_back({read(first, run_of(run).second), number, run});
  }
  std::vector<Flight>::iterator next() {
    return std::ranges::min_element(flights_, {},
                                    [](const Flight& f) { return std::pair(f.completion, f.number); });
  }
  void step() {
    const auto flight = next();
    now = flight->completion;
    for (const std::uint32_t id : flight->run) {
      SlowChunk& chunk = chunks[id];
      if (chunk.damaged) {
        fail(id);
        freed_ = true;
        continue;
      }
      chunk.state = "ready";
      events.push_back({Kind::ready, now, id, chunk.place.memory});
      if (chunk.pins > 0) continue;
      unused_.push_back(id);
      freed_ = true;
    }
    flights_.erase(flight);
  }
  void fail(std::uint32_t id) {
    chunks[id].state = "failed";
    ++counters.failed;
    events.push_back({Kind::failed, now, id, chunks[id].place.memory});
  }
  void overflow() {
    std::uint64_t largest = 0;
    for (const std::uint32_t id : waiting_) largest = std::max(largest, chunks[id].place.memory);
    for (std::uint32_t id = static_cast<std::uint32_t>(chunks.size()); !room(largest, false);) {
      SlowChunk& chunk = chunks[--id];
      if (chunk.state != "ready" || chunk.pins == 0 || chunk.place.memory == 0) continue;
      give_up(id, "waiting");
      waiting_.push_back(id);
    }
    waiting_ = on_disk(waiting_);
    Ids left = waiting_;
    handed.clear();
    while (!left.empty()) {
      const auto [count, pages] = run_of(left);
      const Nanoseconds start = now;
      now = read(left[0], pages);
      counters.overflow_time += now - start;
      for (std::size_t i = 0; i < count; ++i) {
        const std::uint32_t id = left[i];
        make_room(chunks[id].place.memory, false);
        ++counters.overflow_chunks;
        counters.overflow_bytes += chunks[id].place.bytes;
        counters.bytes_wanted += chunks[id].place.bytes;
        if (chunks[id].damaged) {
          std::erase(waiting_, id);
          fail(id);
          continue;
        }
        events.push_back({Kind::overflow, now, id, chunks[id].place.memory});
        handed.push_back(id);
      }
      left.erase(left.begin(), left.begin() + static_cast<std::ptrdiff_t>(count));
    }
  }

  VirtualDisk disk_;
  ChunkCacheOptions options_;
  std::uint64_t table_;
  Ids fetch_, waiting_, prefetch_, unused_;
  std::set<std::uint32_t> wished_;
  std::vector<Flight> flights_;
  bool freed_ = false;
};

}  // namespace vismat::test
