// The bytes of a file, checked block by block, each block when it is first needed.
#pragma once
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

namespace vismat {

/// Corrects the checksums of a file that consists of a head, the checksums of the body's blocks, and the body. The head
/// ends in two checksums: that of the blocks' checksums, and that of the head before it.
void seal(std::span<std::byte> file, std::size_t head_bytes, std::uint64_t body_bytes);

/// `body` in blocks of block_bytes; `sums` has the CRC-32 of each, in four bytes. Both are borrowed. Thread-safe.
class CheckedBytes {
 public:
  static constexpr std::uint64_t block_bytes = 4096;
  static std::uint64_t blocks_of(std::uint64_t bytes) { return (bytes + block_bytes - 1) / block_bytes; }

  CheckedBytes() = default;
  CheckedBytes(std::span<const std::byte> body, std::span<const std::byte> sums);

  /// The same bytes, which must lie in the body, after a check. Throws FormatError if a block's checksum differs.
  std::span<const std::byte> checked(std::span<const std::byte> bytes) const {
    if (bytes.empty()) return bytes;
    const auto begin = static_cast<std::uint64_t>(bytes.data() - body_.data());
    const std::uint64_t first = begin / block_bytes, last = (begin + bytes.size() - 1) / block_bytes;
    if (last - first > 1 || !(is_good(first) && is_good(last))) [[unlikely]]
      check(first, last);
    return bytes;
  }

 private:
  bool is_good(std::uint64_t block) const { return good_[block].load(std::memory_order_relaxed) != 0; }
  void check(std::uint64_t first, std::uint64_t last) const;
  std::span<const std::byte> body_, sums_;
  // 1 for each block after its check. Blocks never change, so a thread that does not see it yet only checks again.
  std::unique_ptr<std::atomic<std::uint8_t>[]> good_;
};

}  // namespace vismat
