// Arrays of fixed-size records, as level files store them.
#pragma once
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "matrix/base/byte_reader.h"

namespace vismat {

/// Levels are stored with the lowest byte of a number first, but for some of consoles.
inline std::int32_t with_bytes_reversed(std::int32_t number) {
  return static_cast<std::int32_t>(__builtin_bswap32(static_cast<std::uint32_t>(number)));
}
inline const std::string big_endian =
    "its numbers have the highest byte first, as on some consoles; only files with the lowest byte first are "
    "read";

/// All records of a lump. If the last one is cut off it throws a FormatError that begins with `lump_name`.
template <typename Record>
std::vector<Record> read_records(std::span<const std::byte> lump, const std::string& lump_name) {
  static_assert(std::is_trivially_copyable_v<Record>);
  if (lump.size() % sizeof(Record) != 0) {
    throw FormatError(lump_name + ": " + std::to_string(lump.size()) + " bytes are no whole number of " +
                      std::to_string(sizeof(Record)) + "-byte records");
  }
  std::vector<Record> records(lump.size() / sizeof(Record));
  if (!records.empty()) std::memcpy(records.data(), lump.data(), lump.size());
  return records;
}

}  // namespace vismat
