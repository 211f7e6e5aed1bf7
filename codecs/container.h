// `.vmat`: one compressed visibility matrix in a file. docs/vmat.md gives the layout.
#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "codecs/codec.h"
#include "matrix/permutation.h"

namespace vismat {

struct Container {
  Shape shape;
  std::uint64_t ones = 0;
  std::string codec;
  Encoded encoded;
  std::optional<ObjectTree> tree;        // over the columns; to codecs over a tree the columns are its nodes
  std::optional<Permutation> row_order;  // the payload's rows stand in this order: row r at new_of_old()[r]
  std::string facts;                     // what the source file said of the matrix, one `key: value` a line
  bool operator==(const Container&) const = default;
};

/// Same container, same bytes.
std::vector<std::byte> write_container(const Container& container);
/// Throws FormatError on bytes that write_container cannot have made: wrong magic, another version, sections
/// that overlap the end, a checksum that differs, a tree that is none. Allocates no more than a few times the
/// file's size.
Container read_container(std::span<const std::byte> bytes);

/// The checksum in a file's last 8 bytes, over all bytes before them: FNV-1a of 64 bits, each of whose steps
/// is a bijection of the state, so that any one changed byte changes the sum.
std::uint64_t container_checksum(std::span<const std::byte> bytes);

/// Encodes with the rows in `row_order` (null: as they stand). Throws what the codec throws.
Container compress(const VisibilityMatrix& matrix, const Codec& codec, const ObjectTree* tree = nullptr,
                   const Permutation* row_order = nullptr);
/// The matrix, rows in their own order again. `codec` must be the one that the container names. FormatError
/// where the payload does not decode to the shape and number of ones that the container states.
VisibilityMatrix decompress(const Container& container, const Codec& codec);

}  // namespace vismat
