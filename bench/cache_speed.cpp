// Measures how fast the cache of chunks replays a walk: frames a second, without anything that is drawn or decoded.
//
// 20,000 chunks lie in a store that the system keeps in memory. 1000 are pinned; in every frame 150 are unpinned and 150 others pinned,
// the cache waits until they are there, and the clock goes on by 16 ms. The cache has room for twice what is pinned, so that in every
// frame 150 chunks are read, checked, and evicted.
//   near       what comes in a frame lies side by side in the store, and is one read
//   scattered  it lies anywhere, and is nearly as many reads as chunks
//   prefetch   what comes in the next three frames is asked for in advance
#include <benchmark/benchmark.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <numeric>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "bench/google_benchmark.h"
#include "bench/verbs.h"
#include "matrix/base/random.h"
#include "runtime/storage/chunk_cache.h"

namespace vismat::bench {
namespace {

constexpr std::uint32_t chunks = 20'000, in_view = 1000, changes = 150;

void write_chunks(const std::filesystem::path& path, std::uint32_t mean_bytes) {
  Random random(1);
  ChunkStoreWriter writer(path, "random bytes", 0, chunks);
  std::vector<std::byte> bytes;
  for (std::uint32_t chunk = 0; chunk < chunks; ++chunk) {
    bytes.resize(mean_bytes / 2 + random.below(mean_bytes));
    for (std::byte& byte : bytes) byte = static_cast<std::byte>(random.below(256));
    writer.append(chunk, bytes);
  }
  writer.finish();
}

struct Walk {
  bool scattered, prefetch;
  unsigned threads;
};

void replay(benchmark::State& state, const ChunkStore& store, const Walk& walk) {
  std::vector<std::uint32_t> order(chunks);
  std::iota(order.begin(), order.end(), 0u);
  Random random(2);
  for (std::uint32_t i = chunks; walk.scattered && i > 1; --i)
    std::swap(order[i - 1], order[random.below(i)]);
  std::vector<std::uint32_t> ids;
  const auto from = [&](std::uint32_t first, std::uint32_t count) -> std::span<const std::uint32_t> {
    ids.resize(count);
    for (std::uint32_t i = 0; i < count; ++i) ids[i] = order[(first + i) % chunks];
    std::ranges::sort(ids);  // the order on disk
    return ids;
  };
  std::uint64_t bytes = 0;
  for (std::uint32_t chunk = 0; chunk < chunks; ++chunk) bytes += store.bytes(chunk);
  ChunkCacheOptions options;
  options.threads = walk.threads;
  const DiskModel& disk = disk_model("nvme");
  options.budget = ChunkCache({source_of(store)}, disk, options).bytes() + 2 * in_view * bytes / chunks;
  ChunkCache cache({source_of(store)}, disk, options);
  cache.pin(from(0, in_view));
  cache.wait();
  const ChunkCounters before = cache.counters();
  std::uint32_t first = 0;
  for (auto _ : state) {
    cache.unpin(from(first, changes));
    cache.pin(from(first + in_view, changes));
    first = (first + changes) % chunks;
    if (walk.prefetch) cache.prefetch(from(first + in_view, 3 * changes));
    cache.advance(cache.wait() + 16'000'000);
  }
  const auto frames = static_cast<double>(state.iterations());
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations()));
  state.counters["reads"] = static_cast<double>(cache.counters().reads - before.reads) / frames;
  state.counters["evicted"] = static_cast<double>(cache.counters().evicted - before.evicted) / frames;
  state.counters["hits"] = static_cast<double>(cache.counters().hits - before.hits) / frames;
}

void run_cache_speed() {
  const std::filesystem::path path =
      std::filesystem::temp_directory_path() / ("vismat-cache-speed-" + std::to_string(::getpid()));
  std::vector<ChunkStore> stores;
  stores.reserve(2);
  for (const std::uint32_t mean_bytes : {500u, 4000u}) {
    write_chunks(path, mean_bytes);
    const ChunkStore& store = stores.emplace_back(path);
    std::filesystem::remove(path);  // it stays as long as it is open
    for (const unsigned threads : {1u, 2u}) {
      for (const bool scattered : {false, true}) {
        for (const bool prefetch : {false, true}) {
          const Walk walk{scattered, prefetch, threads};
          const std::string name = std::to_string(mean_bytes) + "-bytes/" +
                                   (scattered ? "scattered" : "near") + (prefetch ? "/prefetch" : "") +
                                   (threads > 1 ? "/2-threads" : "");
          benchmark::RegisterBenchmark(name.c_str(), [&store, walk](benchmark::State& state) {
            replay(state, store, walk);
          })->MeasureProcessCPUTime();
        }
      }
    }
  }
  benchmark::RunSpecifiedBenchmarks();
}

}  // namespace

void add_cache_speed(const Verb& verb) {
  verb.note(
      "Other arguments are Google Benchmark's: --benchmark_filter=REGEX, --benchmark_repetitions=9, ...");
  verb.example("bench cache-speed --benchmark_filter=500-bytes");
  verb.runs_with_rest([](const std::vector<std::string>& arguments) {
    start_google_benchmark(arguments, "bench cache-speed");
    run_cache_speed();
  });
}

}  // namespace vismat::bench
