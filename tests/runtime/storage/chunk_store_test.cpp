// Stores of chunks: round trips, bytes, and every way in which a small one can be damaged.
#include "runtime/storage/chunk_store.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cstring>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "matrix/base/checksum.h"
#include "matrix/base/random.h"
#include "tests/matrix/temporary_folder.h"
#include "tests/refusal.h"

namespace vismat {
namespace {

using test::refusal;
using Bytes = std::vector<std::byte>;

Bytes bytes_of(std::string_view text) {
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

Bytes read_chunk(const ChunkStore& store, std::uint32_t chunk) {
  Bytes bytes(store.bytes(chunk));
  store.read(chunk, bytes);
  return bytes;
}

void write_small(const std::filesystem::path& path) {
  ChunkStoreWriter writer(path, "words of a test", 0x01020304, 4);
  writer.append(2, bytes_of("two"));
  writer.append(3, {});
  writer.append(0, bytes_of("zero"));
  writer.append(1, bytes_of("first"));
  writer.finish();
}

// The place of the u32 that a test damages is right again in the checksum, so that what lies behind it is looked at.
void seal(Bytes& file) {
  const auto count = number_at<std::uint32_t>(file, 20), text = number_at<std::uint32_t>(file, 24);
  Bytes sealed(file.begin(), file.begin() + 28 + text);
  sealed.insert(sealed.end(), file.end() - 4 - 16 * count, file.end() - 4);
  const std::uint32_t sum = crc32(sealed);
  std::memcpy(file.data() + file.size() - 4, &sum, 4);
}

class ChunkStoreFile : public testing::Test {
 protected:
  std::string refused(const Bytes& file) {
    write_file(path_, file);
    const std::string text = refusal<FormatError>([&] { ChunkStore store(path_); });
    EXPECT_TRUE(text.empty() || text.starts_with(path_.string() + ": ")) << text;
    return text.empty() ? text : text.substr(path_.string().size() + 2);
  }

  TemporaryFolder folder_;
  std::filesystem::path path_ = folder_ / "chunks.store";
};

TEST_F(ChunkStoreFile, GivesBackWhatWasWritten) {
  Random random(1);
  for (const std::uint32_t count : {0u, 1u, 2u, 300u}) {
    std::vector<Bytes> chunks(count);
    std::vector<std::uint32_t> order(count);
    for (std::uint32_t i = 0; i < count; ++i) {
      order[i] = i;
      chunks[i].resize(random.below(3) == 0 ? 0 : random.below(10'000));
      for (std::byte& byte : chunks[i]) byte = static_cast<std::byte>(random.below(256));
    }
    for (std::uint32_t i = count; i > 1; --i) std::swap(order[i - 1], order[random.below(i)]);
    ChunkStoreWriter writer(path_, "numbers", 77, count);
    for (const std::uint32_t chunk : order) writer.append(chunk, chunks[chunk]);
    writer.finish();

    const ChunkStore store(path_);
    ASSERT_EQ(store.count(), count);
    EXPECT_EQ(store.scene_checksum(), 77u);
    EXPECT_EQ(store.contents(), "numbers");
    EXPECT_EQ(store.path(), path_);
    std::uint64_t end = 28 + 7;
    for (const std::uint32_t chunk : order) {
      EXPECT_EQ(store.offset(chunk), end);
      end += chunks[chunk].size();
      EXPECT_EQ(read_chunk(store, chunk), chunks[chunk]);
    }
    store.forget_pages();
    for (const std::uint32_t chunk : order) EXPECT_EQ(read_chunk(store, chunk), chunks[chunk]);
  }
}

// The checksums are those of zlib.
TEST_F(ChunkStoreFile, HasTheseBytes) {
  write_small(path_);
  const std::string_view golden(
      "\x89VCHK\r\n\x1a"
      "\1\0\0\0"
      "\4\3\2\1"
      "\0\x10\0\0"
      "\4\0\0\0"
      "\x0f\0\0\0words of a test"
      "two"
      "zero"
      "first"
      "\x2e\x00\x00\x00\x00\x00\x00\x00\x04\x00\x00\x00\x92\xf1\xde\xab"
      "\x32\x00\x00\x00\x00\x00\x00\x00\x05\x00\x00\x00\x57\xee\x71\x92"
      "\x2b\x00\x00\x00\x00\x00\x00\x00\x03\x00\x00\x00\x66\x8a\xca\x11"
      "\x2e\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00"
      "\x61\x1b\x7f\x8b",
      8 + 4 * 5 + 15 + 12 + 4 * 16 + 4);
  const Bytes file = read_file(path_);
  std::string text(reinterpret_cast<const char*>(file.data()), file.size());
  EXPECT_EQ(testing::PrintToString(text), testing::PrintToString(std::string(golden)));
}

TEST_F(ChunkStoreFile, EveryPrefixAndEveryByteMoreIsRefused) {
  write_small(path_);
  const Bytes file = read_file(path_);
  for (std::size_t size = 0; size < file.size(); ++size)
    EXPECT_NE(refused(Bytes(file.begin(), file.begin() + static_cast<std::ptrdiff_t>(size))), "") << size;
  for (const int more : {0, 1, 255}) {
    Bytes longer = file;
    longer.push_back(static_cast<std::byte>(more));
    EXPECT_NE(refused(longer), "") << more;
  }
  EXPECT_EQ(refused(file), "");
}

TEST_F(ChunkStoreFile, EveryFlippedBitIsRefusedThenOrWhenItsChunkIsRead) {
  write_small(path_);
  const Bytes file = read_file(path_);
  const std::size_t payload = 28 + 15;
  for (std::size_t bit = 0; bit < 8 * file.size(); ++bit) {
    Bytes damaged = file;
    damaged[bit / 8] ^= static_cast<std::byte>(1 << bit % 8);
    if (bit / 8 < payload || bit / 8 >= payload + 12) {
      EXPECT_NE(refused(damaged), "") << bit;
      continue;
    }
    write_file(path_, damaged);
    const ChunkStore store(path_);
    for (std::uint32_t chunk = 0; chunk < 4; ++chunk) {
      const bool hit = bit / 8 >= store.offset(chunk) && bit / 8 < store.offset(chunk) + store.bytes(chunk);
      const std::string text = refusal<FormatError>([&] { read_chunk(store, chunk); });
      const std::string expected = path_.string() + ": chunk " + std::to_string(chunk) + " at offset " +
                                   std::to_string(store.offset(chunk)) +
                                   " is damaged: its checksum is not right";
      EXPECT_EQ(text, hit ? expected : "") << bit;
    }
  }
}

TEST_F(ChunkStoreFile, IndexThatCannotBeIsRefusedThoughItsChecksumIsRight) {
  write_small(path_);
  const Bytes file = read_file(path_);
  const std::size_t index = 28 + 15 + 12;
  const auto with = [&](std::size_t at, auto number) {
    Bytes changed = file;
    std::memcpy(changed.data() + at, &number, sizeof number);
    seal(changed);
    return refused(changed);
  };
  EXPECT_EQ(with(8, 2u), "offset 8: version 2; this program reads version 1");
  EXPECT_EQ(with(16, 512u), "offset 16: pages of 512 bytes, not 4096");
  EXPECT_EQ(with(28, '\n'), "offset 28: control characters in what the chunks are");
  // Chunk 0 at 46, 4 bytes; 1 at 50, 5 bytes; 2 at 43, 3 bytes; 3 at 46, none; the index at 55.
  EXPECT_EQ(with(index, std::uint64_t{45}),
            "chunk 0 begins at offset 45, within what stands before it, which ends at 46");
  EXPECT_EQ(with(index + 48, std::uint64_t{48}),
            "chunk 3 begins at offset 48, within what stands before it, which ends at 50");
  EXPECT_EQ(with(index + 32, std::uint64_t{40}),
            "chunk 2 begins at offset 40, within what stands before it, which ends at 43");
  EXPECT_EQ(with(index + 32, std::uint64_t{44}),
            "chunk 2 begins at offset 44, not where what stands before it ends, at 43");
  EXPECT_EQ(with(index + 16, ~std::uint64_t{0}), "chunk 1 ends beyond offset 55, where the index begins");
  EXPECT_EQ(with(index + 24, ~0u), "chunk 1 ends beyond offset 55, where the index begins");
  EXPECT_EQ(with(index + 24, 4u), "its chunks end at offset 54, and its index begins at 55");
  Bytes claims = file;
  const std::uint32_t many = ~0u;
  std::memcpy(claims.data() + 20, &many, 4);
  EXPECT_EQ(
      refused(claims),
      "has 123 bytes, too few for its head and the index of 4294967295 chunks: it was cut, or is damaged");
}

TEST_F(ChunkStoreFile, CutWhileItIsOpenIsToldWhenAChunkIsRead) {
  write_small(path_);
  const ChunkStore store(path_);
  std::filesystem::resize_file(path_, 48);
  EXPECT_EQ(read_chunk(store, 2), bytes_of("two"));
  EXPECT_EQ(refusal<FormatError>([&] { read_chunk(store, 0); }),
            path_.string() + ": chunk 0 was cut off after the file was opened");
}

TEST_F(ChunkStoreFile, WhatIsNoFileOrNotThere) {
  EXPECT_NE(refusal<std::runtime_error>([&] { ChunkStore store(path_); }), "");
  EXPECT_NE(refusal<std::runtime_error>([&] { ChunkStore store(path_.parent_path()); }), "");
}

TEST_F(ChunkStoreFile, WriterRefusesWhatTheFormatDoesNotHold) {
  write_file(path_, bytes_of("old"));
  for (const std::string& contents : {std::string(), std::string("a\nb"), std::string(1001, 'a')})
    EXPECT_THROW(ChunkStoreWriter(path_, contents, 0, 0), std::invalid_argument);
  {
    ChunkStoreWriter writer(path_, "c", 0, 2);
    writer.append(1, bytes_of("x"));
    EXPECT_EQ(refusal<std::invalid_argument>([&] { writer.append(1, {}); }), "chunk 1 was already appended");
    EXPECT_EQ(refusal<std::invalid_argument>([&] { writer.append(2, {}); }), "chunk 2 of 2 does not exist");
    EXPECT_EQ(refusal<std::invalid_argument>([&] { writer.finish(); }), "chunk 0 was not appended");
  }
  EXPECT_EQ(read_file(path_), bytes_of("old"));  // nothing half-written
  EXPECT_EQ(folder_.entries(), 1u);
}

TEST_F(ChunkStoreFile, Moves) {
  write_small(path_);
  ChunkStore store(path_);
  ChunkStore moved(std::move(store));
  EXPECT_EQ(read_chunk(moved, 1), bytes_of("first"));
  {
    ChunkStoreWriter writer(path_, "other", 5, 1);
    writer.append(0, bytes_of("0"));
    writer.finish();
  }
  moved = ChunkStore(path_);
  EXPECT_EQ(moved.contents(), "other");
  EXPECT_EQ(read_chunk(moved, 0), bytes_of("0"));
}

TEST_F(ChunkStoreFile, ThreadsShareIt) {
  {
    ChunkStoreWriter writer(path_, "numbers", 0, 100);
    for (std::uint32_t chunk = 0; chunk < 100; ++chunk)
      writer.append(chunk, Bytes(100 + chunk, static_cast<std::byte>(chunk)));
    writer.finish();
  }
  const ChunkStore store(path_);
  std::atomic<int> wrong = 0;
  std::vector<std::thread> threads;
  for (std::uint32_t t = 0; t < 4; ++t) {
    threads.emplace_back([&store, &wrong, t] {
      for (std::uint32_t i = 0; i < 200; ++i) {
        const std::uint32_t chunk = (i * 7 + t * 31) % 100;
        wrong += read_chunk(store, chunk) != Bytes(100 + chunk, static_cast<std::byte>(chunk));
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(wrong, 0);
}

}  // namespace
}  // namespace vismat
