// The small sections of a `.vmat` file, to bytes and back: trees, orders, groups, boundaries, names, levels of detail,
// bands. docs/vmat.md gives the layout.
#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "codecs/entropy/bit_stream.h"
#include "matrix/base/byte_reader.h"
#include "matrix/source_map.h"

namespace vismat {

// Absent orders, groups, boundaries, names, levels and bands have no bytes. Readers throw FormatError on bytes that the
// writer cannot have made. They take n log n time and linear memory in the bytes, besides 2^22 places that bytes need
// not back.

/// `nodes`: whether the columns are the tree's nodes.
std::vector<std::byte> tree_bytes(const ObjectTree& tree, bool nodes);
std::pair<ObjectTree, bool> tree_from_bytes(std::span<const std::byte> bytes);

std::vector<std::byte> order_bytes(const Permutation& order);
std::optional<Permutation> order_from_bytes(std::span<const std::byte> bytes, std::uint32_t size);

/// Codes for each member how far back the previous member of its group is, since members of a group tend to be close.
std::vector<std::byte> group_bytes(const Partition& groups);
std::optional<Partition> groups_from_bytes(std::span<const std::byte> bytes, std::uint32_t groups);
/// The end of a section of groups, in every version of the format: the group of each member, and the bits behind it.
struct CodedGroups {
  std::vector<std::uint32_t> group_of_member;
  BitReader rest;
};
CodedGroups read_coded_groups(ByteReader& in, std::uint32_t members, std::uint32_t groups);
/// The length of group_bytes; 0 for no groups.
std::size_t group_size(const std::optional<Partition>& groups);

std::vector<std::byte> boundary_bytes(std::span<const Boundary> boundaries);
std::vector<Boundary> boundaries_from_bytes(std::span<const std::byte> bytes, std::uint32_t rows);

/// Throws std::invalid_argument if the names are hundreds of times as long as their coded bytes.
std::vector<std::byte> name_bytes(std::span<const std::string> names);
std::vector<std::string> names_from_bytes(std::span<const std::byte> bytes);

std::vector<std::byte> level_bytes(std::span<const ObjectLevel> levels);
std::vector<ObjectLevel> levels_from_bytes(std::span<const std::byte> bytes);

/// The first rows of the bands, ascending from row 0. Throws std::invalid_argument if they are not.
std::vector<std::byte> band_bytes(std::span<const std::uint32_t> bands, std::uint32_t rows);
std::vector<std::uint32_t> bands_from_bytes(std::span<const std::byte> bytes, std::uint32_t rows);

/// Reads a number of a section. Throws FormatError if it takes more than 32 bits; `what` names the number in the
/// message.
std::uint32_t small_varint(ByteReader& in, const char* what);

}  // namespace vismat
