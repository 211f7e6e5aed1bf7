// A file of chunks, such as the triangles of each object at each level of detail, that lie in any order on disk and are read one at
// a time.
#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "matrix/base/atomic_file.h"
#include "matrix/base/byte_reader.h"

namespace vismat {

// The format, version 1. All numbers are little-endian.
//
//   offset  bytes
//   0       8      magic: 89 56 43 48 4b 0d 0a 1a ("VCHK" between bytes that a transfer as text damages)
//   8       4      u32 version, 1
//   12      4      u32 checksum of the scene from which the chunks were made
//   16      4      u32 page size by which reads are counted, 4096
//   20      4      u32 n, the number of chunks
//   24      4      u32 t, the bytes of the next field, 1 to 1000
//   28      t      what the chunks are: one line of text without control characters (bytes below 0x20, and 0x7f)
//   28 + t  ...    the chunks' bytes, in the order on disk, without gaps
//   e       16 n   the index. For each chunk: u64 offset in the file, u32 bytes, u32 CRC-32 of the bytes
//   ...     4      u32 CRC-32 of the bytes 0 to 28 + t and of the index, one behind the other
//
// e is 4 + 16 n bytes before the end of the file. Chunks may have no bytes; the offset of such a one is where those that
// follow begin. The CRC-32 is that of gzip and zip.

/// Writes a store from front to back. The file stands under its name after finish(), complete; before that, after an
/// exception, or after a kill, what stood there stays. Memory: 16 bytes a chunk.
class ChunkStoreWriter {
 public:
  /// Throws std::invalid_argument if `contents` is no line of text as the format allows, std::runtime_error if the file
  /// cannot be written.
  ChunkStoreWriter(const std::filesystem::path& path, std::string_view contents, std::uint32_t scene_checksum,
                   std::uint32_t chunk_count);

  /// Puts a chunk behind those before it. Throws std::invalid_argument if it does not exist, was already appended or
  /// has 2^32 bytes or more; std::runtime_error if the disk is full.
  void append(std::uint32_t chunk, std::span<const std::byte> bytes);
  /// Throws std::invalid_argument, naming the first, if a chunk was not appended; std::runtime_error as append does.
  void finish();

 private:
  void put(std::span<const std::byte> bytes);

  AtomicFile file_;
  AtomicFileStream stream_;
  std::vector<std::byte> head_and_index_;
  std::size_t head_bytes_ = 0;
  std::uint64_t end_ = 0;
  std::vector<bool> appended_;
};

/// Reads a store. Threads may share it.
class ChunkStore {
 public:
  /// Checks the head and the index, not the chunks. Throws FormatError naming the file and what is wrong with it,
  /// std::runtime_error if it cannot be read. O(chunks log chunks); keeps 16 bytes a chunk.
  explicit ChunkStore(std::filesystem::path path);
  ~ChunkStore();
  ChunkStore(ChunkStore&& other) noexcept;
  ChunkStore& operator=(ChunkStore&& other) noexcept;

  std::uint32_t count() const { return static_cast<std::uint32_t>(entries_.size()); }
  std::uint64_t offset(std::uint32_t chunk) const { return entries_[chunk].offset; }
  std::uint32_t bytes(std::uint32_t chunk) const { return entries_[chunk].bytes; }
  std::uint32_t scene_checksum() const { return scene_checksum_; }
  std::string_view contents() const { return contents_; }
  const std::filesystem::path& path() const { return path_; }

  /// Fills `memory`, of bytes(chunk) bytes, by pread. Throws FormatError naming the file and the chunk if it was cut
  /// off or its checksum is not right (`memory` then holds nothing of use), std::runtime_error if the disk refuses.
  void read(std::uint32_t chunk, std::span<std::byte> memory) const;
  /// Gives the file's pages that the system keeps in memory back, so that the next reads are cold; what others write
  /// or map is kept. A hint, which nothing but timings shows.
  void forget_pages() const;

 private:
  struct Entry {
    std::uint64_t offset;
    std::uint32_t bytes, checksum;
  };
  void read_index();
  std::vector<std::byte> bytes_at(std::uint64_t offset, std::size_t count) const;
  std::size_t read_some(std::uint64_t offset, std::span<std::byte> memory) const;

  std::filesystem::path path_;
  int file_ = -1;
  std::uint32_t scene_checksum_ = 0;
  std::string contents_;
  std::vector<Entry> entries_;
};

}  // namespace vismat
