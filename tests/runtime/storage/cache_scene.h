// Sources of made-up chunks, and random walks through them.
#pragma once
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "matrix/base/byte_reader.h"
#include "matrix/base/random.h"
#include "runtime/storage/chunk_cache.h"

namespace vismat::test {

/// What a chunk's memory holds.
inline std::byte content(std::uint32_t source, std::uint32_t chunk, std::size_t i) {
  return static_cast<std::byte>(source * 101 + chunk * 7 + i);
}

struct MadeChunks {
  std::vector<ChunkPlace> places;
  std::vector<bool> damaged;
};

/// The chunks are borrowed.
inline ChunkSource made_source(const MadeChunks& chunks, std::uint32_t source) {
  const MadeChunks* const made = &chunks;
  return {static_cast<std::uint32_t>(chunks.places.size()),
          [made](std::uint32_t chunk) { return made->places[chunk]; },
          [made, source](std::uint32_t chunk, std::span<std::byte> memory) {
            if (made->damaged[chunk]) throw FormatError("made " + std::to_string(chunk) + ": is damaged");
            for (std::size_t i = 0; i < memory.size(); ++i) memory[i] = content(source, chunk, i);
          }};
}

/// Sources with gaps, shared bytes, empty chunks, and chunks that take more memory than they have bytes.
inline std::vector<MadeChunks> made_chunks(std::uint32_t sources, std::uint32_t count, std::uint32_t largest,
                                           double damaged, Random& random) {
  std::vector<MadeChunks> all(sources);
  for (MadeChunks& made : all) {
    std::uint64_t offset = random.below(100);
    for (std::uint32_t i = 0; i < count; ++i) {
      const std::uint64_t bytes =
          random.below(5) == 0 ? 0 : random.below(random.below(4) == 0 ? largest : largest / 8);
      const std::uint64_t memory = random.below(3) == 0 ? std::uint64_t{random.below(largest)} : bytes;
      if (random.below(6) == 0) offset += random.below(3 * largest);
      const bool shares = random.below(10) == 0 && !made.places.empty();
      made.places.push_back(shares ? made.places[random.below(i)] : ChunkPlace{offset, bytes, memory});
      if (!shares) offset += bytes;
      made.damaged.push_back(random.fraction() < damaged);
    }
    for (std::uint32_t i = count; i > 1; --i) std::swap(made.places[i - 1], made.places[random.below(i)]);
  }
  return all;
}

inline std::vector<ChunkSource> sources_of(const std::vector<MadeChunks>& all) {
  std::vector<ChunkSource> sources;
  for (std::uint32_t s = 0; s < all.size(); ++s) sources.push_back(made_source(all[s], s));
  return sources;
}

/// A viewer whose visible chunks drift, which now and then jumps, waits or goes on without waiting.
struct RandomWalk {
  using Ids = std::vector<std::uint32_t>;
  RandomWalk(std::uint32_t chunks, std::uint32_t in_view, std::uint64_t seed)
      : random(seed), count(chunks), view(in_view) {}

  /// Makes a step: what to unpin, pin and prefetch.
  void step() {
    unpin.clear();
    pin.clear();
    prefetch.clear();
    const std::uint32_t changes = random.below(20) == 0 ? view : random.below(view / 2 + 1);
    for (std::uint32_t i = 0; i < changes && !pinned.empty(); ++i) {
      const std::uint32_t at = random.below(static_cast<std::uint32_t>(pinned.size()));
      unpin.push_back(pinned[at]);
      pinned.erase(pinned.begin() + at);
    }
    const std::uint32_t base = random.below(count);
    const auto near = [&] { return (base + random.below(2 * view)) % count; };
    while (pinned.size() < view && random.below(30) != 0) {
      pin.push_back(near());  // now and then one that is pinned already
      pinned.push_back(pin.back());
    }
    prefetches = random.below(3) == 0;
    for (std::uint32_t i = random.below(2 * view); i > 0; --i) prefetch.push_back(near());
    waits = random.below(3) == 0;
    pause = random.below(4) == 0 ? 0 : random.below(30'000'000);
  }

  Random random;
  std::uint32_t count, view;
  Ids pinned, unpin, pin, prefetch;
  bool prefetches = false, waits = false;
  Nanoseconds pause = 0;
};

}  // namespace vismat::test
