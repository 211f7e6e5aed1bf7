#include "codecs/checked_bytes.h"

#include <algorithm>
#include <cstring>
#include <string>

#include "matrix/byte_reader.h"
#include "matrix/checksum.h"

namespace vismat {

CheckedBytes::CheckedBytes(std::span<const std::byte> body, std::span<const std::byte> sums)
    : body_(body), sums_(sums), good_(std::make_unique<std::atomic<std::uint64_t>[]>((blocks() + 63) / 64)) {}

void CheckedBytes::check(std::uint64_t block) const {
  const std::uint64_t begin = block * block_bytes;
  std::uint32_t sum;
  std::memcpy(&sum, sums_.data() + 4 * block, sizeof sum);
  if (crc32(body_.subspan(begin, std::min(block_bytes, body_.size() - begin))) != sum) {
    throw FormatError(".vmat: the checksum of bytes " + std::to_string(begin) + " on of " +
                      std::to_string(body_.size()) + " of the body differs: the file is damaged");
  }
  good_[block / 64].fetch_or(std::uint64_t{1} << (block % 64), std::memory_order_relaxed);
}

}  // namespace vismat
