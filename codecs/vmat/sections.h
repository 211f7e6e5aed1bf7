// The small sections of a `.vmat` file, to bytes and back: trees, orders, groups, boundaries, names, levels, bands. docs/vmat.md
// gives the layout.
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

// No bytes stand for no order, groups, boundaries, names, levels or bands. What reads throws FormatError on bytes that the
// writer cannot have made, in time n log n and memory linear in them, but for 2^22 places that bytes need not back.

/// `nodes`: the columns are the tree's nodes.
std::vector<std::byte> tree_bytes(const ObjectTree& tree, bool nodes);
std::pair<ObjectTree, bool> tree_from_bytes(std::span<const std::byte> bytes);

std::vector<std::byte> order_bytes(const Permutation& order);
std::optional<Permutation> order_from_bytes(std::span<const std::byte> bytes, std::uint32_t size);

/// Members of a group tend to stand near one another: each tells how far back the last one of its group stands.
std::vector<std::byte> group_bytes(const Partition& groups);
std::optional<Partition> groups_from_bytes(std::span<const std::byte> bytes, std::uint32_t groups);
/// What the section ends in, in every version of the format: the group of each member, and the bits behind.
struct CodedGroups {
  std::vector<std::uint32_t> group_of_member;
  BitReader rest;
};
CodedGroups read_coded_groups(ByteReader& in, std::uint32_t members, std::uint32_t groups);
/// As many bytes as group_bytes has; 0 for no groups.
std::size_t group_size(const std::optional<Partition>& groups);

std::vector<std::byte> boundary_bytes(std::span<const Boundary> boundaries);
std::vector<Boundary> boundaries_from_bytes(std::span<const std::byte> bytes, std::uint32_t rows);

std::vector<std::byte> name_bytes(std::span<const std::string> names);
std::vector<std::string> names_from_bytes(std::span<const std::byte> bytes);

std::vector<std::byte> level_bytes(std::span<const ObjectLevel> levels);
std::vector<ObjectLevel> levels_from_bytes(std::span<const std::byte> bytes);

/// First rows of bands, from row 0 on and ascending. Throws std::invalid_argument where they are not. Names: where they are
/// hundreds of times as long as what tells them.
std::vector<std::byte> band_bytes(std::span<const std::uint32_t> bands, std::uint32_t rows);
std::vector<std::uint32_t> bands_from_bytes(std::span<const std::byte> bytes, std::uint32_t rows);

/// A number of a section. Throws FormatError where it takes more than 32 bits; `what` tells what it is.
std::uint32_t small_varint(ByteReader& in, const char* what);

}  // namespace vismat
