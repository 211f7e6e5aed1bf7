// The cache of chunks by hand, against a slow one event by event, and with several threads.
#include "runtime/storage/chunk_cache.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <memory_resource>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "tests/matrix/temporary_folder.h"
#include "tests/refusal.h"
#include "tests/runtime/storage/cache_scene.h"
#include "tests/runtime/storage/slow_cache.h"
#include "tests/sanitized.h"

namespace vismat {
namespace {

using test::refusal;
using Ids = std::vector<std::uint32_t>;
using State = ChunkCache::State;

// A page takes 1000 ns, and a read 10000 ns more.
const DiskModel even_disk{"even", 10'000, 0, 4.096e9, 1, ""};

// Chunks of one page each, in memory too, one behind the other; `far` lies apart.
test::MadeChunks pages(std::uint32_t count, const Ids& far = {}) {
  test::MadeChunks made;
  std::uint64_t page = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    if (std::ranges::find(far, i) != far.end()) page += 10;
    made.places.push_back({4096 * page++, 4096, 4096});
  }
  made.damaged.resize(count, false);
  return made;
}

std::uint64_t table_of(const test::MadeChunks& made, const DiskModel& disk) {
  return ChunkCache({test::made_source(made, 0)}, disk).bytes();
}

// A cache that has room for so many pages.
struct PageCache {
  PageCache(test::MadeChunks chunks, std::uint64_t room, const DiskModel& disk = even_disk)
      : made(std::move(chunks)), cache({test::made_source(made, 0)}, disk, options(room, disk)) {}
  ChunkCacheOptions options(std::uint64_t room, const DiskModel& disk) {
    return {.budget = table_of(made, disk) + 4096 * room,
            .watch = [this](const ChunkEvent& event) { events.push_back(event); }};
  }
  Ids of(ChunkEvent::Kind kind) {
    Ids chunks;
    for (const ChunkEvent& event : events) {
      if (event.kind == kind) chunks.push_back(event.chunk);
    }
    return chunks;
  }
  std::vector<ChunkEvent> events;
  test::MadeChunks made;
  ChunkCache cache;
};

using Kind = ChunkEvent::Kind;

TEST(ChunkCache, ReadsRunsAndTimesThem) {
  PageCache p(pages(8, {5}), 8);
  ChunkCache& cache = p.cache;
  EXPECT_EQ(cache.count(), 8u);
  EXPECT_EQ(cache.first(0), 0u);
  cache.pin(Ids{1, 2, 4, 5, 6, 0});
  EXPECT_EQ(cache.state(1), State::queued);
  EXPECT_EQ(cache.missing(), 6u);
  // 1 and 2, then 4 alone, since all of page 3 lies between, then 5 and 6, then 0.
  EXPECT_EQ(cache.wait(), 12'000 + 11'000 + 12'000 + 11'000);
  EXPECT_EQ(p.of(Kind::read), (Ids{1, 4, 5, 0}));
  EXPECT_EQ(cache.state(1), State::ready);
  EXPECT_EQ(cache.state(3), State::absent);
  EXPECT_EQ(cache.data(6)[10], test::content(0, 6, 10));
  EXPECT_EQ(cache.missing(), 0u);
  ChunkCounters expected;
  expected.requests = expected.pages = 6;
  expected.reads = 4;
  expected.bytes_read = expected.bytes_wanted = 6 * 4096;
  expected.peak_bytes = cache.bytes();
  EXPECT_EQ(cache.counters(), expected);
  cache.pin(Ids{1, 7});
  EXPECT_EQ(cache.counters().hits, 1u);
  EXPECT_EQ(cache.wait(), 46'000 + 11'000);
}

TEST(ChunkCache, PagesCountOnceInARunAndARunHasALimit) {
  test::MadeChunks made;
  for (std::uint64_t i = 0; i < 100; ++i) made.places.push_back({100 * i, 100, 100});
  made.places.push_back({4096 * 3 - 1, 2, 2});  // behind a page of which nobody asks for anything
  made.damaged.resize(101, false);
  ChunkCache cache({test::made_source(made, 0)}, even_disk, {.run_bytes = 2 * 4096});
  Ids all(101);
  for (std::uint32_t i = 0; i < 101; ++i) all[i] = i;
  cache.pin(all);
  cache.wait();  // chunk 81 begins in page 1 and ends in page 2, where chunk 100 begins, which ends in page 3
  EXPECT_EQ(cache.counters().reads, 3u);
  EXPECT_EQ(cache.counters().pages, 6u);
  EXPECT_EQ(cache.counters().bytes_wanted, 100u * 100 + 2);
}

TEST(ChunkCache, ChannelsWorkSideBySide) {
  DiskModel two = even_disk;
  two.channels = 2;
  PageCache p(pages(3, {1, 2}), 8, two);
  p.cache.pin(Ids{0, 1, 2});
  p.cache.advance(10'999);
  EXPECT_EQ(p.cache.state(0), State::reading);
  EXPECT_EQ(p.cache.state(1), State::reading);
  EXPECT_EQ(p.cache.state(2), State::queued);
  p.cache.pin(Ids{1});
  EXPECT_EQ(p.cache.counters().hits_in_flight, 1u);
  p.cache.advance(11'000);
  EXPECT_EQ(p.cache.state(1), State::ready);
  EXPECT_EQ(p.cache.state(2), State::reading);
  EXPECT_EQ(p.cache.wait(), 22'000);
}

TEST(ChunkCache, WhatWasUsedLongestAgoGoesFirst) {
  PageCache p(pages(10), 3);
  const auto look = [&](std::uint32_t chunk) {
    p.cache.pin(Ids{chunk});
    p.cache.wait();
    p.cache.unpin(Ids{chunk});
  };
  for (const std::uint32_t chunk : {0, 1, 2, 0, 3, 4, 0, 5}) look(chunk);
  EXPECT_EQ(p.of(Kind::evicted), (Ids{1, 2, 3}));
  EXPECT_EQ(p.cache.counters().evicted_bytes, 3u * 4096);
  EXPECT_EQ(p.cache.counters().hits, 2u);
  p.cache.pin(Ids{0});  // is no longer the next to go
  look(6);
  look(7);
  EXPECT_EQ(p.of(Kind::evicted), (Ids{1, 2, 3, 4, 5}));
  EXPECT_EQ(p.cache.state(0), State::ready);
}

TEST(ChunkCache, WhatIsUnpinnedBeforeItsTurnIsNotRead) {
  PageCache p(pages(4, {1, 2, 3}), 4);
  p.cache.pin(Ids{0, 1, 2});
  p.cache.advance(5'000);
  p.cache.unpin(Ids{1, 0});
  EXPECT_EQ(p.cache.state(1), State::absent);
  EXPECT_EQ(p.cache.wait(), 22'000);
  EXPECT_EQ(p.of(Kind::ready), (Ids{0, 2}));  // 0 was under way
}

TEST(ChunkCache, PinsAreCounted) {
  PageCache p(pages(4), 2);
  p.cache.pin(Ids{0, 0, 1});
  p.cache.wait();
  p.cache.unpin(Ids{0, 1});
  p.cache.pin(Ids{2});
  p.cache.wait();
  EXPECT_EQ(p.of(Kind::evicted), (Ids{1}));
  EXPECT_EQ(p.cache.state(0), State::ready);
  EXPECT_EQ(refusal<std::logic_error>([&] { p.cache.unpin(Ids{0, 0}); }), "chunk 0 is not pinned");
  EXPECT_EQ(refusal<std::logic_error>([&] { p.cache.pin(Ids{4}); }), "chunk 4 of 4 does not exist");
  EXPECT_EQ(refusal<std::logic_error>([&] { p.cache.data(1); }), "chunk 1 is not ready");
  EXPECT_EQ(refusal<std::logic_error>([&] { p.cache.advance(0); }), "the clock cannot go back");
}

TEST(ChunkCache, PrefetchesWaitForFetches) {
  PageCache p(pages(6, {1, 2, 3, 4, 5}), 6);
  p.cache.prefetch(Ids{3, 4, 5});
  p.cache.pin(Ids{0, 4});
  p.cache.advance(5'000);
  p.cache.pin(Ids{1});
  EXPECT_EQ(p.cache.wait(), 33'000);
  p.cache.advance(38'000);
  EXPECT_EQ(p.of(Kind::read), (Ids{0, 4, 1, 3}));
  p.cache.prefetch(Ids{2});  // not 5 any more, but 3 is under way
  p.cache.pin(Ids{3});
  p.cache.advance(100'000);
  EXPECT_EQ(p.of(Kind::read), (Ids{0, 4, 1, 3, 2}));
  const ChunkCounters& counters = p.cache.counters();
  EXPECT_EQ(counters.prefetched, 2u);
  EXPECT_EQ(counters.prefetched_used, 1u);
  EXPECT_EQ(counters.prefetch_replaced, 1u);
  EXPECT_EQ(counters.hits_in_flight, 1u);
}

TEST(ChunkCache, APrefetchEvictsNothingOfItsOwnList) {
  PageCache p(pages(10), 4);
  p.cache.pin(Ids{0, 1, 2, 3});
  p.cache.wait();
  p.cache.unpin(Ids{0, 1, 2});
  p.cache.prefetch(Ids{7, 0, 8, 2, 9});  // 3 is pinned, 0 and 2 are asked for: only 1 may go
  p.cache.advance(1'000'000);
  EXPECT_EQ(p.of(Kind::evicted), (Ids{1}));
  EXPECT_EQ(p.of(Kind::dropped), (Ids{8, 9}));
  EXPECT_EQ(p.cache.counters().prefetch_dropped, 2u);
  p.cache.prefetch(Ids{1});
  p.cache.advance(2'000'000);
  EXPECT_EQ(p.of(Kind::evicted), (Ids{1, 0}));  // the order of use is as it was
}

TEST(ChunkCache, APinnedSetThatIsTooLargeIsReadInOrderHandedOverAndDropped) {
  PageCache p(pages(8), 3);
  std::vector<std::pair<std::uint32_t, std::byte>> handed;
  const auto handle = [&](std::uint32_t chunk, std::span<const std::byte> data) {
    handed.emplace_back(chunk, data[5]);
  };
  p.cache.pin(Ids{6, 2, 1, 5, 0});
  p.cache.advance(1'000'000);
  EXPECT_EQ(p.cache.missing(), 2u);
  EXPECT_EQ(p.cache.wait(handle), 1'000'000 + 10'000 + 2'000 + 10'000 + 1'000);
  // 6, 2 and 1 had room; 6 is taken back for the two others.
  EXPECT_EQ(p.of(Kind::evicted), (Ids{6}));
  EXPECT_EQ(p.of(Kind::overflow), (Ids{0, 5, 6}));
  ASSERT_EQ(handed.size(), 3u);
  for (const auto& [chunk, byte] : handed) EXPECT_EQ(byte, test::content(0, chunk, 5));
  const ChunkCounters& counters = p.cache.counters();
  EXPECT_EQ(counters.overflow_chunks, 3u);
  EXPECT_EQ(counters.overflow_bytes, 3u * 4096);
  EXPECT_EQ(counters.overflow_time, 23'000);
  EXPECT_LE(counters.peak_bytes, table_of(p.made, even_disk) + 3 * 4096);
  p.cache.wait(handle);  // the same again
  EXPECT_EQ(handed.size(), 6u);
  EXPECT_EQ(counters.overflow_chunks, 6u);
  p.cache.unpin(Ids{2, 1});
  p.cache.wait(handle);
  EXPECT_EQ(p.cache.missing(), 0u);
  EXPECT_EQ(handed.size(), 6u);
}

TEST(ChunkCache, OverflowSurvivesWhatItsHandleThrows) {
  PageCache p(pages(4), 1);
  p.cache.pin(Ids{0, 1, 2});
  EXPECT_THROW(
      p.cache.wait([](std::uint32_t, std::span<const std::byte>) { throw std::runtime_error("no"); }),
      std::runtime_error);
  Ids handed;
  p.cache.wait([&](std::uint32_t chunk, std::span<const std::byte>) { handed.push_back(chunk); });
  EXPECT_EQ(handed, (Ids{0, 1, 2}));
}

TEST(ChunkCache, ABudgetBelowTheLargestChunkIsRefused) {
  test::MadeChunks made = pages(3);
  made.places[1].memory = 5000;
  const std::uint64_t table = table_of(made, even_disk);
  const auto with = [&](std::uint64_t budget) {
    return refusal<std::invalid_argument>(
        [&] { ChunkCache({test::made_source(made, 0)}, even_disk, {.budget = budget}); });
  };
  EXPECT_EQ(with(table + 5000), "");
  EXPECT_EQ(with(table + 4999), "a cache of " + std::to_string(table + 4999) +
                                    " bytes is too small: its table takes " + std::to_string(table) +
                                    " and the largest chunk 5000");
  EXPECT_NE(with(0), "");
  EXPECT_NE(refusal<std::invalid_argument>([] { ChunkCache({}, even_disk, {.page_bytes = 0}); }), "");
  EXPECT_NE(refusal<std::invalid_argument>([] { ChunkCache({}, even_disk, {.threads = 17}); }), "");
}

TEST(ChunkCache, TakesItsTableAndItsChunksFromTheResourceGiven) {
  struct Counted : std::pmr::memory_resource {
    void* do_allocate(std::size_t bytes, std::size_t alignment) override {
      live += bytes;
      return std::pmr::new_delete_resource()->allocate(bytes, alignment);
    }
    void do_deallocate(void* memory, std::size_t bytes, std::size_t alignment) override {
      live -= bytes;
      std::pmr::new_delete_resource()->deallocate(memory, bytes, alignment);
    }
    bool do_is_equal(const memory_resource& other) const noexcept override { return this == &other; }
    std::size_t live = 0;
  } counted;
  const test::MadeChunks made = pages(50);
  {
    ChunkCache cache({test::made_source(made, 0)}, even_disk, {.memory = &counted});
    const std::size_t table = counted.live;
    EXPECT_GE(table, 50u * 32);
    cache.pin(Ids{3, 4, 9});
    cache.wait();
    EXPECT_EQ(counted.live, table + 3 * 4096);
  }
  EXPECT_EQ(counted.live, 0u);
}

TEST(ChunkCache, WithoutChunks) {
  ChunkCache cache({}, even_disk);
  cache.pin({});
  cache.prefetch({});
  EXPECT_EQ(cache.wait(), 0);
  cache.advance(5);
  EXPECT_EQ(cache.now(), 5);
  EXPECT_TRUE(cache.failures().empty());
}

TEST(ChunkCache, DamagedChunksOfAStoreAreToldAndTheOthersGoOn) {
  const TemporaryFolder folder;
  const std::filesystem::path path = folder / "some.store";
  {
    ChunkStoreWriter writer(path, "letters", 1, 100);
    for (std::uint32_t chunk = 0; chunk < 100; ++chunk)
      writer.append(chunk, std::vector<std::byte>(chunk == 3 ? 0 : 100, static_cast<std::byte>(chunk)));
    writer.finish();
  }
  const ChunkStore store(path);
  std::vector<std::byte> file = read_file(path);
  for (std::uint32_t chunk = 1; chunk < 100; chunk += 4) file[store.offset(chunk)] ^= std::byte{8};
  {
    std::ofstream out(path, std::ios::binary | std::ios::in);  // in place
    out.write(reinterpret_cast<const char*>(file.data()), static_cast<std::streamsize>(file.size()));
  }
  for (const unsigned threads : {1u, 2u}) {
    ChunkCache cache({source_of(store)}, even_disk, {.threads = threads});
    Ids all(100);
    for (std::uint32_t i = 0; i < 100; ++i) all[i] = i;
    cache.pin(all);
    cache.wait();
    const auto failures = cache.failures();
    ASSERT_EQ(failures.size(), 25u);
    for (std::uint32_t i = 0; i < 25; ++i) {
      EXPECT_EQ(failures[i].chunk, 1 + 4 * i);
      const std::string message = path.string() + ": chunk " + std::to_string(1 + 4 * i) + " at offset " +
                                  std::to_string(store.offset(1 + 4 * i)) +
                                  " is damaged: its checksum is not right";
      EXPECT_EQ(failures[i].message, i < 16 ? message.substr(0, 255) : "");
      EXPECT_EQ(cache.state(1 + 4 * i), State::failed);
    }
    EXPECT_EQ(cache.data(2)[99], std::byte{2});
    EXPECT_EQ(cache.data(3).size(), 0u);
    EXPECT_EQ(cache.counters().failed, 25u);
    EXPECT_EQ(cache.counters().reads, 1u);
    cache.unpin(all);
    cache.pin(all);
    EXPECT_EQ(cache.missing(), 0u);              // they are not tried again
    EXPECT_EQ(cache.counters().hits, 74u + 2u);  // with the empty one, which always is there
  }
}

// What differs from the slow cache after a step.
std::string difference(const ChunkCache& cache, const test::SlowCache& slow,
                       const std::vector<ChunkEvent>& events) {
  for (std::size_t i = 0; i < std::min(events.size(), slow.events.size()); ++i) {
    if (!(events[i] == slow.events[i])) {
      const auto text = [](const ChunkEvent& e) {
        return std::to_string(static_cast<int>(e.kind)) + " at " + std::to_string(e.time) + " of " +
               std::to_string(e.chunk) + ", " + std::to_string(e.amount);
      };
      return "event " + std::to_string(i) + ": " + text(events[i]) + " and slowly " + text(slow.events[i]);
    }
  }
  if (events.size() != slow.events.size()) return "events";
  if (cache.now() != slow.now) return "now";
  if (cache.bytes() != slow.used()) return "bytes";
  if (cache.missing() != slow.missing()) return "missing";
  if (!(cache.counters() == slow.counters)) return "counters";
  for (std::uint32_t chunk = 0; chunk < cache.count(); ++chunk) {
    const std::string& state = slow.chunks[chunk].state;
    const State expected = state == "absent"    ? State::absent
                           : state == "reading" ? State::reading
                           : state == "ready"   ? State::ready
                           : state == "failed"  ? State::failed
                                                : State::queued;
    if (cache.state(chunk) != expected) return "state of " + std::to_string(chunk);
  }
  return "";
}

struct Setting {
  std::uint32_t sources, count, largest, view;
  double damaged, room;  // room: of the budget, in average views
  unsigned channels;
  bool even = false;  // all reads take the same time, so that many end at once
};

void walk_both(const Setting& setting, unsigned threads, int steps, std::uint64_t seed) {
  Random random(seed);
  const auto made =
      test::made_chunks(setting.sources, setting.count, setting.largest, setting.damaged, random);
  std::vector<test::SlowChunk> chunks;
  std::uint64_t sum = 0, largest = 0;
  for (std::uint32_t s = 0; s < made.size(); ++s) {
    for (std::size_t i = 0; i < made[s].places.size(); ++i) {
      chunks.push_back({s, made[s].places[i], made[s].damaged[i]});
      sum += made[s].places[i].memory;
      largest = std::max(largest, made[s].places[i].memory);
    }
  }
  const DiskModel disk{"some",           3'000'000, setting.even ? 0 : 2'000'000, setting.even ? 1e12 : 20e6,
                       setting.channels, ""};
  std::vector<ChunkEvent> events;
  ChunkCacheOptions options{.seed = seed, .page_bytes = 512, .run_bytes = 8192, .threads = threads};
  const std::uint64_t table = ChunkCache(sources_of(made), disk, options).bytes();
  options.budget = table + largest +
                   static_cast<std::uint64_t>(setting.room * setting.view * static_cast<double>(sum) /
                                              static_cast<double>(chunks.size()));
  test::SlowCache slow(chunks, disk, options, table);
  options.watch = [&](const ChunkEvent& event) { events.push_back(event); };
  ChunkCache cache(sources_of(made), disk, options);

  test::RandomWalk walk(static_cast<std::uint32_t>(chunks.size()), setting.view, seed);
  for (int step = 0; step < steps; ++step) {
    walk.step();
    cache.unpin(walk.unpin);
    slow.unpin(walk.unpin);
    cache.pin(walk.pin);
    slow.pin(walk.pin);
    if (walk.prefetches) {
      cache.prefetch(walk.prefetch);
      slow.prefetch(walk.prefetch);
    }
    if (walk.waits) {
      Ids handed;
      slow.handed.clear();
      cache.wait([&](std::uint32_t chunk, std::span<const std::byte> data) {
        handed.push_back(chunk);
        for (std::size_t i = 0; i < data.size(); ++i) {
          const std::uint32_t s = chunks[chunk].source;
          ASSERT_EQ(data[i], test::content(s, chunk - cache.first(s), i));
        }
      });
      slow.wait();
      ASSERT_EQ(handed, slow.handed);
    } else {
      cache.advance(cache.now() + walk.pause);
      slow.advance(slow.now + walk.pause);
    }
    ASSERT_EQ(difference(cache, slow, events), "") << "step " << step << ", seed " << seed;
    ASSERT_LE(cache.counters().peak_bytes, options.budget);
    for (std::uint32_t chunk = 0; chunk < cache.count(); ++chunk) {
      if (cache.state(chunk) != State::ready) continue;
      const auto data = cache.data(chunk);
      ASSERT_EQ(data.size(), chunks[chunk].place.memory);
      const std::uint32_t s = chunks[chunk].source;
      for (std::size_t i = 0; i < data.size(); i += 97)
        ASSERT_EQ(data[i], test::content(s, chunk - cache.first(s), i));
    }
    events.clear();
    slow.events.clear();
  }
  const ChunkCounters& counters = cache.counters();  // that the walk shows something
  EXPECT_GT(counters.hits * counters.reads, 0u);
  if (setting.room < 1) {
    EXPECT_GT(counters.overflow_chunks, 0u);
  }
  if (setting.room < 5) {
    EXPECT_GT(counters.evicted, 0u);
  }
}

const Setting settings[] = {
    {1, 60, 2000, 10, 0, 3, 1},          {3, 40, 3000, 12, .02, 1.5, 3}, {2, 50, 500, 20, .05, .3, 2},
    {1, 30, 4000, 8, 0, 0, 4},           {2, 100, 300, 30, 0, 20, 8},    {4, 20, 1000, 5, .1, .8, 1},
    {2, 80, 400, 15, .02, 1.5, 5, true},
};

TEST(ChunkCache, EqualsTheSlowOneEventByEvent) {
  for (std::uint64_t seed = 1; seed <= test::trials(10u); ++seed) {
    for (const Setting& setting : settings) {
      walk_both(setting, 1, 300, seed);
      if (HasFatalFailure()) return;
    }
  }
}

TEST(ChunkCache, ThreadsChangeNothing) {
  for (const unsigned threads : {2u, 8u}) {
    for (const Setting& setting : settings) {
      walk_both(setting, threads, test::trials(200), 77 + threads);
      if (HasFatalFailure()) return;
    }
  }
}

TEST(ChunkCache, ThreadsEndWithReadsUnderWay) {
  test::MadeChunks made = pages(200);
  ChunkSource slow = test::made_source(made, 0);
  slow.read = [](std::uint32_t, std::span<std::byte>) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  };
  DiskModel disk = even_disk;
  disk.channels = 4;
  ChunkCacheOptions options{.run_bytes = 4096 * 20, .threads = 3};
  Ids all(200);
  for (std::uint32_t i = 0; i < 200; ++i) all[i] = i;
  for (int trial = 0; trial < 5; ++trial) {
    ChunkCache cache({slow}, disk, options);
    cache.pin(all);
    cache.advance(trial);
    EXPECT_EQ(cache.state(0), State::reading);
  }
}

}  // namespace
}  // namespace vismat
