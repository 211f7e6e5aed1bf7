// Unpacks gzip files.
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace vismat {

bool is_gzip(std::span<const std::byte> bytes);
struct Gunzipped {
  std::vector<std::byte> bytes;
  std::uint64_t after_end;  // bytes of the file behind what is packed
};
/// What the gzip file holds; several parts one after another. Throws FormatError if it is damaged or cut short, and if it unpacks
/// to more than 16 MiB and 100 times its size, which no mesh does.
Gunzipped gunzipped(std::span<const std::byte> bytes);

}  // namespace vismat
