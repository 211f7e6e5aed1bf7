// What paper 002's methods share: each node of a tree stores from which of its own cells its children are
// visible.
#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "codecs/codec.h"

namespace vismat {

/// One node's children over the cells that see the node: child i is visible from the node's p-th cell where
/// bits[i * cells + p] is 1. One byte a bit: at most a few hundred kB live at a time, and loops stay plain.
struct ChildBits {
  std::uint32_t children = 0, cells = 0;
  std::vector<std::uint8_t> bits;
};

/// What a method that codes lengths has seen: `bits` bits cut into `lengths` lengths, and what an ideal
/// arithmetic coder with the one histogram of their symbols would need for them, raw bits included.
struct LengthStatistics {
  std::uint64_t bits = 0, lengths = 0;
  double entropy_bytes = 0;
};

/// How one method codes one node's ChildBits. First see() is called for every node if it learns(), then write_model,
/// then encode.
class NodeCoder {
 public:
  virtual ~NodeCoder() = default;
  virtual bool learns() const { return false; }
  virtual void see(const ChildBits&) {}
  virtual LengthStatistics statistics() const { return {}; }
  virtual void write_model(std::vector<std::byte>&) {}
  virtual void encode(const ChildBits&, std::vector<std::byte>& out) const = 0;
  virtual void read_model(ByteReader&) {}
  /// Fills node.bits (children * cells of them) from exactly these bytes; FormatError otherwise.
  virtual void decode(std::span<const std::byte> part, ChildBits& node) const = 0;
};

/// The methods by name; null where the name is not one of a codec over a tree.
std::unique_ptr<NodeCoder> make_node_coder(std::string_view codec);

/// Payload: one byte that says whether every cell sees the root; the model; then the parts in node order. The
/// root that not every cell sees is coded as the only child of a node that every cell sees.
Encoded encode_over_tree(NodeCoder& coder, const VisibilityMatrix& matrix, const ObjectTree* tree);

/// For the tables: zeros where the codec codes no lengths. Throws as its encode does.
LengthStatistics length_statistics(const Codec& codec, const VisibilityMatrix& matrix,
                                   const ObjectTree* tree);

/// Reads one node without the rest: what a client does that pages nodes in. Thread-safe once made.
class NodeReader {
 public:
  /// Borrows the bytes and the tree. Reads the model and the index, O(nodes). Throws as Codec::decode does.
  NodeReader(std::string_view codec, std::span<const std::byte> payload,
             std::span<const std::byte> node_index, Shape shape, const ObjectTree& tree);

  /// The cells that see the root. O(cells).
  std::vector<std::uint32_t> root_cells() const;
  /// For each child of `node` the cells that see it, ascending, given those that see the node. Reads this
  /// node's part alone: O(children * cells of the node).
  std::vector<std::vector<std::uint32_t>> children(std::uint32_t node,
                                                   std::span<const std::uint32_t> cells) const;
  /// The cells that see any node, by the path from the root: reads depth parts.
  std::vector<std::uint32_t> cells(std::uint32_t node) const;
  /// Bytes of the payload that children(node) reads; 0 for a leaf.
  std::uint64_t part_bytes(std::uint32_t node) const { return part_of_node_[node].size(); }

 private:
  Shape shape_;
  const ObjectTree* tree_;
  std::unique_ptr<NodeCoder> coder_;
  bool root_everywhere_ = true;
  std::span<const std::byte> root_part_;
  std::vector<std::span<const std::byte>> part_of_node_;
};

VisibilityMatrix decode_over_tree(std::string_view codec, std::span<const std::byte> payload,
                                  std::span<const std::byte> node_index, Shape shape, const ObjectTree* tree);

}  // namespace vismat
