// The bits of one list of numbers, from the lowest bit of each byte on. Behind them stands a 1, which ends the list,
// and zeros up to a whole byte. A list without numbers has no bytes.
#pragma once
#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include "matrix/base/byte_reader.h"

namespace vismat {

constexpr std::uint64_t lowest_bits(std::uint64_t bits, unsigned count) {  // count < 64
  return bits & ((std::uint64_t{1} << count) - 1);
}

/// Appends one list.
class ListWriter {
 public:
  explicit ListWriter(std::vector<std::byte>& out) : out_(out) {}
  /// The low `count` bits of `bits`, count <= 56; higher bits must be zero.
  void put(std::uint64_t bits, unsigned count) {
    pending_ |= bits << held_;
    held_ += count;
    std::memcpy(block_.data() + used_, &pending_, 8);
    used_ += held_ / 8;
    pending_ >>= held_ & ~7u;
    held_ %= 8;
    if (used_ > block_.size() - 8) [[unlikely]]
      empty();
  }
  /// Ends the list; nothing may follow.
  void finish() {
    put(1, 1);
    put(0, (8 - held_) % 8);
    empty();
  }

 private:
  void empty() {
    out_.insert(out_.end(), block_.begin(), block_.begin() + static_cast<std::ptrdiff_t>(used_));
    used_ = 0;
  }
  std::vector<std::byte>& out_;
  std::uint64_t pending_ = 0;
  unsigned held_ = 0;
  std::size_t used_ = 0;
  std::array<std::byte, 256> block_;
};

/// Reads a list. Borrows the bytes.
class ListBits {
 public:
  /// `what` names the code in messages; it must outlive the object. Throws FormatError if no bit ends the list, or if
  /// it ends after fewer than `least` bits.
  ListBits(std::span<const std::byte> bytes, const char* what, std::size_t least)
      : bytes_(bytes.data()), what_(what) {
    if (bytes.empty()) return;
    const auto last = std::to_integer<unsigned>(bytes.back());
    if (last == 0) fail("the list's last byte is zero");
    stop_ = 8 * bytes.size() - 9 + static_cast<unsigned>(std::bit_width(last));
    if (stop_ < least) fail("the list ends before its first number");
    tail_begin_ = bytes.size() - std::min<std::size_t>(8, bytes.size());
    std::memcpy(tail_, bytes.data() + tail_begin_, bytes.size() - tail_begin_);
  }

  bool ended() const { return place_ >= stop_; }
  /// At least 57 bits, with zeros behind the bytes; at most one bit is past the list's end.
  std::uint64_t peek() const {
    const std::size_t byte = place_ / 8;
    std::uint64_t bits;
    std::memcpy(&bits, byte < tail_begin_ ? bytes_ + byte : tail_ + (byte - tail_begin_), 8);
    return bits >> place_ % 8;
  }
  void take(unsigned count) { place_ += count; }
  /// Throws FormatError if more bits were taken than there are.
  void check() const {
    if (place_ > stop_) fail("the list ends within a number");
  }
  [[noreturn]] void fail(const char* problem) const {
    throw FormatError(std::string(what_) + ", bit " + std::to_string(place_) + ": " + problem);
  }

  /// Fills `out` with the results of next(*this) until the list ends, and returns their number. next may take at least
  /// one and at most 64 bits.
  template <typename Next>
  std::size_t read(std::span<std::uint32_t> out, const Next& next) {
    ListBits here = *this;  // kept in registers
    std::uint32_t* to = out.data();
    std::uint32_t* const end = to + out.size();
    while (to != end && here.place_ < here.stop_) *to++ = next(here);
    place_ = here.place_;
    check();
    return static_cast<std::size_t>(to - out.data());
  }

 private:
  const std::byte* bytes_;
  const char* what_;
  std::size_t tail_begin_ = 0, place_ = 0,
              stop_ = 0;  // from byte tail_begin_ on, tail_ is read in place of bytes_
  std::byte tail_[16] = {};
};

}  // namespace vismat
