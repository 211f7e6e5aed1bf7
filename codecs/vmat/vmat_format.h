// The numbers of the `.vmat` format, version 4; docs/vmat.md explains them.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace vismat::vmat {

constexpr std::array<unsigned char, 8> magic = {0x89, 'V', 'M', 'A', 'T', '\r', '\n', 0x1a};
constexpr std::uint32_t version = 4;
constexpr std::size_t name_bytes = 32;
/// Magic, version, rows, columns, ones, codec name, number of sections.
constexpr std::size_t fixed_head_bytes = 8 + 4 + 4 + 4 + 8 + name_bytes + 4;
/// The number and length of a section.
constexpr std::size_t section_entry_bytes = 4 + 8;
/// The checksum of the blocks' checksums, and that of the head before it.
constexpr std::size_t head_sums_bytes = 4 + 4;

/// Sections come in ascending order of these numbers, each at most once, none empty.
enum class Section : std::uint32_t {
  facts = 1,
  tree = 2,
  row_tree = 3,
  row_order = 4,
  column_order = 5,
  shared_order = 6,  // one order of the rows and of the columns of a square matrix
  row_groups = 7,
  column_groups = 8,
  boundaries = 9,
  row_names = 10,
  column_names = 11,
  column_levels = 12,
  boxes = 13,
  bands = 14,
  index = 15,
  payload = 16,
  list_rows = 17,
  first_shared = 32,
  last_shared = 63,
};

/// Whether a file that begins with these bytes is a `.vmat` file of some version.
inline bool begins_vmat(std::span<const std::byte> begin) {
  for (std::size_t i = 0; i < magic.size(); ++i) {
    if (i >= begin.size() || std::to_integer<unsigned char>(begin[i]) != magic[i]) return false;
  }
  return true;
}

}  // namespace vismat::vmat
