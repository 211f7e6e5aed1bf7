// The checksum of gzip, PNG and zip: CRC-32, reflected polynomial 0xedb88320. It finds any one error of at most 32 bits in a row.
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>

namespace vismat {

/// The checksum of the bytes, computed 8 bytes at a time.
std::uint32_t crc32(std::span<const std::byte> bytes);

}  // namespace vismat
