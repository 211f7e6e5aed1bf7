// What a cache allocates is never above its budget: every allocation of this program is counted, and those made within calls of the
// cache, by whichever thread, are its own.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <memory>
#include <new>

#include "tests/runtime/storage/cache_scene.h"
#include "tests/sanitized.h"

namespace {

std::atomic<bool> within = false;
std::atomic<std::int64_t> live = 0, peak = 0;

// Stands before every block, at its end, so that the block keeps its alignment.
struct Head {
  std::size_t size;
  std::uint32_t offset;  // of the block from what malloc gave
  std::uint32_t counted;
};

void* take(std::size_t size, std::size_t alignment) noexcept {
  const std::size_t offset = std::max(alignment, sizeof(Head));
  void* const start = std::aligned_alloc(offset, (offset + size + offset - 1) / offset * offset);
  if (start == nullptr) return nullptr;
  std::byte* const block = static_cast<std::byte*>(start) + offset;
  auto* const head = reinterpret_cast<Head*>(block - sizeof(Head));
  *head = {size, static_cast<std::uint32_t>(offset), within};
  if (head->counted) {
    const std::int64_t now = live += static_cast<std::int64_t>(size);
    std::int64_t highest = peak;
    while (now > highest && !peak.compare_exchange_weak(highest, now)) {
    }
  }
  return block;
}

void* take_or_throw(std::size_t size, std::size_t alignment) {
  if (void* const memory = take(size, alignment)) return memory;
  throw std::bad_alloc();
}

void give(void* memory) noexcept {
  if (memory == nullptr) return;
  const Head head = reinterpret_cast<Head*>(memory)[-1];
  if (head.counted) live -= static_cast<std::int64_t>(head.size);
  std::free(static_cast<std::byte*>(memory) - head.offset);
}

constexpr std::size_t usual = __STDCPP_DEFAULT_NEW_ALIGNMENT__;
std::size_t number(std::align_val_t alignment) {
  return static_cast<std::size_t>(alignment);
}

}  // namespace

// clang-format off
void* operator new(std::size_t size) { return take_or_throw(size, usual); }
void* operator new[](std::size_t size) { return take_or_throw(size, usual); }
void* operator new(std::size_t size, std::align_val_t a) { return take_or_throw(size, number(a)); }
void* operator new[](std::size_t size, std::align_val_t a) { return take_or_throw(size, number(a)); }
void* operator new(std::size_t size, const std::nothrow_t&) noexcept { return take(size, usual); }
void* operator new[](std::size_t size, const std::nothrow_t&) noexcept { return take(size, usual); }
void* operator new(std::size_t size, std::align_val_t a, const std::nothrow_t&) noexcept { return take(size, number(a)); }
void* operator new[](std::size_t size, std::align_val_t a, const std::nothrow_t&) noexcept { return take(size, number(a)); }
void operator delete(void* memory) noexcept { give(memory); }
void operator delete[](void* memory) noexcept { give(memory); }
void operator delete(void* memory, std::size_t) noexcept { give(memory); }
void operator delete[](void* memory, std::size_t) noexcept { give(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { give(memory); }
void operator delete[](void* memory, std::align_val_t) noexcept { give(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { give(memory); }
void operator delete[](void* memory, std::size_t, std::align_val_t) noexcept { give(memory); }
void operator delete(void* memory, const std::nothrow_t&) noexcept { give(memory); }
void operator delete[](void* memory, const std::nothrow_t&) noexcept { give(memory); }
void operator delete(void* memory, std::align_val_t, const std::nothrow_t&) noexcept { give(memory); }
void operator delete[](void* memory, std::align_val_t, const std::nothrow_t&) noexcept { give(memory); }
// clang-format on

namespace vismat {
namespace {

struct Within {
  Within() { within = true; }
  ~Within() { within = false; }
};

void walk(unsigned threads, double views, std::uint32_t chunks, std::uint32_t largest) {
  Random random(threads);
  const auto made = test::made_chunks(2, chunks, largest, 0, random);
  std::uint64_t sum = 0, most = 0;
  for (const test::MadeChunks& one : made) {
    for (const ChunkPlace& place : one.places) {
      sum += place.memory;
      most = std::max(most, place.memory);
    }
  }
  const std::uint32_t view = chunks / 10;
  const DiskModel disk{"some", 1'000'000, 500'000, 50e6, 4, ""};
  ChunkCacheOptions options{.page_bytes = 512, .run_bytes = 1 << 14, .threads = threads};
  const std::uint64_t table = ChunkCache(test::sources_of(made), disk, options).bytes();
  options.budget =
      table + most + static_cast<std::uint64_t>(views * view * static_cast<double>(sum) / (2 * chunks));
  std::uint64_t seen = 0;
  const ChunkCache::Handle handle = [&](std::uint32_t, std::span<const std::byte> data) {
    seen += data.size();
  };

  ASSERT_EQ(live, 0);
  peak = 0;
  std::unique_ptr<ChunkCache> cache;
  {
    const Within all;
    cache = std::make_unique<ChunkCache>(test::sources_of(made), disk, options);
  }
  const std::int64_t bare = live;
  EXPECT_LE(bare, static_cast<std::int64_t>(cache->bytes()));
  EXPECT_LE(static_cast<std::int64_t>(cache->bytes()), bare + 2048);  // 16 threads that may not be there
  test::RandomWalk way(cache->count(), view, 5);
  for (int step = 0; step < test::trials(500); ++step) {
    way.step();
    {
      const Within all;
      cache->unpin(way.unpin);
      cache->pin(way.pin);
      if (way.prefetches) cache->prefetch(way.prefetch);
      way.waits ? void(cache->wait(handle)) : cache->advance(cache->now() + way.pause);
    }
    ASSERT_EQ(live - bare, static_cast<std::int64_t>(cache->bytes() - table)) << step;
    ASSERT_LE(peak, static_cast<std::int64_t>(options.budget)) << step;
  }
  EXPECT_EQ(peak - bare, static_cast<std::int64_t>(cache->counters().peak_bytes - table));
  if (views < 5) {
    EXPECT_GT(cache->counters().peak_bytes, options.budget - most) << "the walk does not fill the cache";
  }
  if (views < 1) {
    EXPECT_GT(seen, 0u);
  }
  cache.reset();
  EXPECT_EQ(live, 0);
}

TEST(CacheMemory, NeverExceedsTheBudget) {
  for (const unsigned threads : {1u, 2u, 8u}) {
    for (const double views : {0., .5, 2., 30.}) {
      walk(threads, views, 300, 3000);
      walk(threads, views, 1000, 50);  // of which the table is the larger part
      if (HasFatalFailure()) return;
    }
  }
}

}  // namespace
}  // namespace vismat
