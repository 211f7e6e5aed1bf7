#include "matrix/base/byte_reader.h"

namespace vismat {

std::span<const std::byte> ByteReader::bytes(std::size_t count) {
  if (count > left()) {
    fail("needs " + std::to_string(count) + " more bytes, but only " + std::to_string(left()) + " are left");
  }
  const auto taken = bytes_.subspan(offset_, count);
  offset_ += count;
  return taken;
}

std::uint64_t ByteReader::varint() {
  std::uint64_t value = 0;
  for (unsigned shift = 0;; shift += 7) {
    const auto byte = number<std::uint8_t>();
    if (shift == 63 && byte > 1) fail("a number takes more than 64 bits");
    value |= std::uint64_t{byte & 0x7fu} << shift;
    if (byte == 0 && shift > 0) fail("a number is written in more bytes than it needs");
    if (byte < 0x80) return value;
  }
}

void ByteReader::fail(const std::string& message) const {
  throw FormatError(std::string(what_) + ": at byte " + std::to_string(offset_) + ": " + message);
}

}  // namespace vismat
