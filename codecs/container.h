// `.vmat`: one compressed visibility matrix in a file. docs/vmat.md gives the layout. read_container takes in all of it;
// row_reader.h reads single rows of a file that stays where it is.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "codecs/codec.h"
#include "matrix/deltas.h"
#include "matrix/partition.h"
#include "matrix/permutation.h"

namespace vismat {

struct Container {
  Shape shape;
  std::uint64_t ones = 0;
  std::string codec;
  Encoded encoded;
  std::optional<ObjectTree> tree;  // over the columns; to codecs over a tree of columns these are its nodes
  std::optional<ObjectTree> row_tree;  // its objects are the rows
  /// Where the rows and columns of the source stand in this file, if it was reordered (Dataset's row_order, column_order), or
  /// which one stands for them, if they were merged (row_groups, column_groups); of a side at most one of the two.
  std::optional<Permutation> row_order, column_order;
  std::optional<Partition> row_groups, column_groups;
  /// Between which view cells the rows are differences, as in Deltas; then there are two rows a boundary.
  std::vector<Boundary> boundaries;
  std::string facts;  // what the source file said of the matrix, one `key: value` a line
  bool operator==(const Container&) const = default;
};

/// Same container, same bytes.
std::vector<std::byte> write_container(const Container& container);
/// Throws FormatError on bytes that write_container cannot have made: wrong magic, another version, sizes that do not add
/// up to the file's, a checksum that differs, a tree or an order that is none. Allocates no more than a few times the
/// file's size.
Container read_container(std::span<const std::byte> bytes);

/// Around what the codec has made of the matrix.
Container container_of(const VisibilityMatrix& matrix, const Codec& codec, Encoded encoded);
/// Encodes the matrix as it stands; the container keeps the tree, on the codec's side. Throws what the codec throws.
Container compress(const VisibilityMatrix& matrix, const Codec& codec, const ObjectTree* tree = nullptr);
/// The matrix as it stands in the file. `codec` must be the one that the container names. FormatError where the payload
/// does not decode to the shape and number of ones that the container states.
VisibilityMatrix decompress(const Container& container, const Codec& codec);

/// The head of a file and where its sections lie; what a reader checks before it touches anything else.
class ContainerHead {
 public:
  static constexpr std::uint64_t block_bytes = 4096;  // of the body, a checksum each
  enum Section {
    facts, tree, row_tree, row_order, column_order, row_groups, column_groups, boundaries, index, payload, sections
  };

  /// Checks magic, version, the head's checksum, that the sections fill the file exactly, and the checksum over the blocks'
  /// checksums. O(blocks); reads nothing of the body. Throws FormatError.
  explicit ContainerHead(std::span<const std::byte> file);

  Shape shape;
  std::uint64_t ones = 0;
  std::string codec;
  /// Borrowed from the file. Its bytes are unchecked until check_block went over their blocks.
  std::span<const std::byte> section(Section which) const { return section_[which]; }
  std::span<const std::byte> body() const { return body_; }
  std::uint64_t blocks() const { return (body_.size() + block_bytes - 1) / block_bytes; }
  /// Throws FormatError where the block's checksum differs.
  void check_block(std::uint64_t block) const;

 private:
  std::span<const std::byte> sums_, body_;
  std::array<std::span<const std::byte>, sections> section_;
};

/// Makes every checksum right in bytes whose head tells sizes that fit the file; other bytes stay as they are. The
/// writer's last step, and what a fuzzer needs.
void seal_container(std::span<std::byte> file);

}  // namespace vismat
