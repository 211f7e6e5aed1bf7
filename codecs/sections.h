// The small sections of a `.vmat` file, to bytes and back: trees, orders, groups, boundaries. docs/vmat.md gives the layout.
#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "matrix/deltas.h"
#include "matrix/object_tree.h"
#include "matrix/partition.h"
#include "matrix/permutation.h"

namespace vismat {

// No bytes stand for no tree, order, groups or boundaries. What reads throws FormatError on bytes that the writer cannot have
// made, in time and memory linear in them.

std::vector<std::byte> tree_bytes(const std::optional<ObjectTree>& tree);
std::optional<ObjectTree> tree_from_bytes(std::span<const std::byte> bytes);

std::vector<std::byte> order_bytes(const std::optional<Permutation>& order);
std::optional<Permutation> order_from_bytes(std::span<const std::byte> bytes, std::uint32_t size);

/// Members of a group tend to stand near one another: each tells how far back the last one of its group stands.
std::vector<std::byte> group_bytes(const std::optional<Partition>& groups);
std::optional<Partition> groups_from_bytes(std::span<const std::byte> bytes, std::uint32_t groups);

std::vector<std::byte> boundary_bytes(std::span<const Boundary> boundaries);
std::vector<Boundary> boundaries_from_bytes(std::span<const std::byte> bytes, std::uint32_t rows);

}  // namespace vismat
