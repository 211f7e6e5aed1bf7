// Reads little-endian bytes with bounds checks, and FormatError, which every reader throws on bad bytes.
#pragma once
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <span>
#include <stdexcept>
#include <string>

namespace vismat {

/// Bad bytes in a file or payload. The message says where (lump, dataset, offset), what is wrong and what would be
/// right; whoever opened the file puts its name in front.
struct FormatError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Returns what work() returns; a FormatError that it throws then names the file, or the level in it.
template <typename Work>
auto naming(const std::filesystem::path& where, const Work& work) {
  try {
    return work();
  } catch (const FormatError& error) {
    throw FormatError(where.string() + ": " + error.what());
  }
}

/// The little-endian number that begins at byte `at`; the bytes must hold it.
template <typename Number>
Number number_at(std::span<const std::byte> bytes, std::size_t at) {
  Number value;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

/// Reads forward through borrowed bytes; every read past the end throws FormatError naming the offset.
class ByteReader {
 public:
  /// `what` names the bytes in messages ("lump 16 (visdata)"); it must outlive the reader.
  ByteReader(std::span<const std::byte> bytes, const char* what) : bytes_(bytes), what_(what) {}

  std::size_t offset() const { return offset_; }
  std::size_t left() const { return bytes_.size() - offset_; }
  /// The next `count` bytes, borrowed.
  std::span<const std::byte> bytes(std::size_t count);
  void skip(std::size_t count) { bytes(count); }
  /// A little-endian number: u8, i16, u32, u64, float ...
  template <typename Number>
  Number number() {
    return number_at<Number>(bytes(sizeof(Number)), 0);
  }
  /// Unsigned LEB128 in as few bytes as the value needs, at most 64 bits.
  std::uint64_t varint();
  /// Throws a FormatError that begins with the name and the offset.
  [[noreturn]] void fail(const std::string& message) const;

 private:
  std::span<const std::byte> bytes_;
  const char* what_;
  std::size_t offset_ = 0;
};

static_assert(std::endian::native == std::endian::little, "vismat reads and writes little-endian files");

}  // namespace vismat
