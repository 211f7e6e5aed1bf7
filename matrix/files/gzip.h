// Unpacks gzip, in which matrix collections hand out their files.
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace vismat {

bool is_gzip(std::span<const std::byte> bytes);
/// How much a file of matrices may unpack to, so that a small one cannot fill the memory: 1 GiB, or 200 bytes for each
/// packed one if that is more. Text of entries unpacks to at most some 20.
std::uint64_t most_unpacked(std::uint64_t packed);
/// What the members of a gzip file unpack to, one after another. Throws FormatError for damage, for a file that ends
/// early, and at more than `most` bytes. Other bytes than zeros behind the last member are refused, or counted if `after_end`
/// is given.
std::vector<std::byte> gunzip(std::span<const std::byte> packed, std::uint64_t most,
                              std::uint64_t* after_end = nullptr);

}  // namespace vismat
