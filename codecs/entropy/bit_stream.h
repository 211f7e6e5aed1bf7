// Streams of bits in bytes, least significant bit first.
#pragma once
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

#include "matrix/base/byte_reader.h"

namespace vismat {

class BitWriter {
 public:
  explicit BitWriter(std::vector<std::byte>& out) : out_(out) {}
  /// The low `count` bits of `bits`, count <= 32; higher bits must be zero.
  void put(std::uint64_t bits, unsigned count) {
    pending_ |= bits << held_;
    held_ += count;
    for (; held_ >= 8; held_ -= 8, pending_ >>= 8) out_.push_back(static_cast<std::byte>(pending_ & 0xff));
  }
  /// Pads with zero bits to a byte.
  void flush() {
    if (held_ > 0) out_.push_back(static_cast<std::byte>(pending_ & 0xff));
    pending_ = 0;
    held_ = 0;
  }

 private:
  std::vector<std::byte>& out_;
  std::uint64_t pending_ = 0;
  unsigned held_ = 0;
};

/// Reads bits. Past the end it reads zeros: one test at the end, finish(), finds what ran over.
class BitReader {
 public:
  explicit BitReader(std::span<const std::byte> bytes) : bytes_(bytes) {}
  /// At least 32 bits, without taking them.
  std::uint32_t peek() {
    for (; held_ < 32; held_ += 8) {
      const std::uint64_t byte = next_ < bytes_.size() ? std::to_integer<std::uint64_t>(bytes_[next_]) : 0;
      ++next_;
      window_ |= byte << held_;
    }
    return static_cast<std::uint32_t>(window_);
  }
  void take(unsigned count) {  // after a peek, count <= 32
    window_ >>= count;
    held_ -= count;
  }
  std::uint32_t get(unsigned count) {
    const std::uint32_t bits = count == 32 ? peek() : peek() & ((std::uint32_t{1} << count) - 1);
    take(count);
    return bits;
  }
  std::size_t bytes_taken() const { return next_ - held_ / 8; }
  bool overran() const { return bytes_taken() > bytes_.size(); }
  /// Throws FormatError unless the reading ended in the last byte and its padding is zero.
  void finish() const {
    if (bytes_taken() != bytes_.size()) {
      throw FormatError("bits end in byte " + std::to_string(bytes_taken()) + " of " +
                        std::to_string(bytes_.size()));
    }
    if ((window_ & ((std::uint64_t{1} << (held_ % 8)) - 1)) != 0)
      throw FormatError("the padding bits are not zero");
  }

 private:
  std::span<const std::byte> bytes_;
  std::size_t next_ = 0;
  std::uint64_t window_ = 0;
  unsigned held_ = 0;
};

/// The bits of eight bytes that are 0 or 1, the first lowest. A product moves each to its place in the top byte.
inline std::uint64_t bits_of_eight(const std::uint8_t* bytes) {
  std::uint64_t eight;
  std::memcpy(&eight, bytes, 8);
  return eight * 0x0102040810204080u >> 56;
}

/// Writes bytes that are 0 or 1 as bits, and reads them back.
inline void put_bits(BitWriter& out, std::span<const std::uint8_t> bits) {
  std::size_t i = 0;
  for (; i + 8 <= bits.size(); i += 8) out.put(bits_of_eight(bits.data() + i), 8);
  for (; i < bits.size(); ++i) out.put(bits[i], 1);
}
inline void get_bits(BitReader& in, std::span<std::uint8_t> bits) {
  std::size_t i = 0;
  for (; i + 8 <= bits.size(); i += 8) {
    const std::uint32_t eight = in.get(8);
    for (unsigned j = 0; j < 8; ++j) bits[i + j] = eight >> j & 1;
  }
  for (; i < bits.size(); ++i) bits[i] = static_cast<std::uint8_t>(in.get(1));
}

/// The 8 bytes from `at` <= bytes.size() on, with zeros behind the end.
inline std::uint64_t word_at(std::span<const std::byte> bytes, std::size_t at) {
  std::uint64_t word = 0;
  if (bytes.size() - at >= 8) [[likely]]
    std::memcpy(&word, bytes.data() + at, 8);
  else
    std::memcpy(&word, bytes.data() + at, bytes.size() - at);
  return word;
}

inline void put_varint(std::vector<std::byte>& out, std::uint64_t value) {
  for (; value >= 0x80; value >>= 7) out.push_back(static_cast<std::byte>((value & 0x7f) | 0x80));
  out.push_back(static_cast<std::byte>(value));
}
/// How many bytes that takes.
inline std::size_t varint_bytes(std::uint64_t value) {
  return (static_cast<std::size_t>(std::bit_width(value | 1)) + 6) / 7;
}

}  // namespace vismat
