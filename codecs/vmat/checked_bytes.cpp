#include "codecs/vmat/checked_bytes.h"

#include <algorithm>
#include <cstring>
#include <string>

#include "matrix/base/byte_reader.h"
#include "matrix/base/checksum.h"

namespace vismat {
namespace {

std::uint32_t sum_of_block(std::span<const std::byte> body, std::uint64_t block) {
  const std::uint64_t begin = block * CheckedBytes::block_bytes;
  return crc32(body.subspan(begin, std::min(CheckedBytes::block_bytes, body.size() - begin)));
}

}  // namespace

void seal(std::span<std::byte> file, std::size_t head_bytes, std::uint64_t body_bytes) {
  const auto store = [&](std::size_t at, std::uint32_t sum) {
    std::memcpy(file.data() + at, &sum, sizeof sum);
  };
  const auto body = file.last(body_bytes);
  const std::uint64_t blocks = CheckedBytes::blocks_of(body_bytes);
  for (std::uint64_t b = 0; b < blocks; ++b) store(head_bytes + 4 * b, sum_of_block(body, b));
  store(head_bytes - 8, crc32(file.subspan(head_bytes, 4 * blocks)));
  store(head_bytes - 4, crc32(file.first(head_bytes - 4)));
}

CheckedBytes::CheckedBytes(std::span<const std::byte> body, std::span<const std::byte> sums)
    : body_(body),
      sums_(sums),
      good_(std::make_unique<std::atomic<std::uint8_t>[]>(blocks_of(body.size()))) {}

void CheckedBytes::check(std::uint64_t first, std::uint64_t last) const {
  for (std::uint64_t block = first; block <= last; ++block) {
    if (is_good(block)) continue;
    if (sum_of_block(body_, block) != number_at<std::uint32_t>(sums_, 4 * block)) {
      throw FormatError(".vmat: the checksum of bytes " + std::to_string(block * block_bytes) + " on of " +
                        std::to_string(body_.size()) + " of the body differs: the file is damaged");
    }
    good_[block].store(1, std::memory_order_relaxed);
  }
}

}  // namespace vismat
