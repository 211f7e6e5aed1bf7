// Sets on a tree, each node's inside its parent's: what the codecs over a tree share. Over a tree of columns a node's set is
// the rows (view cells) that see it [Zach & Karner 2003]; over a tree of rows it is the columns (objects) that some row below
// the node sees [Gotsman et al. 1999]. Each node stores which of its own set are in its children's.
#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "codecs/codec.h"

namespace vismat {

/// One node's set, with what a reader knows who came down from the root.
struct NodeSet {
  std::uint32_t node = 0;
  std::vector<std::uint32_t> members;  // ascending
  /// Of each member, by codecs that ask for it (NodeCoder::wants_history); else empty. Bit i of its history, i < 8, tells
  /// whether the sibling of the node's i-th ancestor has it, the node being its 0-th. Two members are of one kind where the
  /// whole history agrees up to the root; kinds are numbered in the order of their first members.
  std::vector<std::uint8_t> history;
  std::vector<std::uint32_t> kind;
};

/// One node's children over the members of its set: child i has the p-th member where bits[i * members + p] is 1. One byte a
/// bit: at most a few hundred kB live at a time, and loops stay plain.
struct ChildBits {
  std::uint32_t children = 0, members = 0;
  std::vector<std::uint8_t> bits;
  // The rest is told by the tree and the way down, to writer and reader alike.
  const NodeSet* set = nullptr;  // of the node itself
  std::uint32_t universe = 0;    // members are below this
  std::uint32_t leafs = 0;       // of the tree below the node
  bool first_child = false;      // the node is its parent's first
  /// The only child is the root, the set that of everything.
  bool of_root = false;

  std::span<const std::uint8_t> child(std::uint32_t i) const {
    return std::span(bits).subspan(std::size_t{i} * members, members);
  }
};

/// What a method that codes lengths has seen: `bits` bits cut into `lengths` lengths, and what an ideal
/// arithmetic coder with the one histogram of their symbols would need for them, raw bits included.
struct LengthStatistics {
  std::uint64_t bits = 0, lengths = 0;
  double entropy_bytes = 0;
};

/// How one method codes one node's ChildBits. First expect, then see() is called for every node if it learns(), then
/// write_model, then encode.
class NodeCoder {
 public:
  virtual ~NodeCoder() = default;
  /// Which side of the matrix the tree stands over. Over rows it is binary, each row in one leaf, and a node's set is the
  /// union of its two children's.
  virtual TreeOver side() const { return TreeOver::columns; }
  virtual bool wants_history() const { return false; }
  virtual bool learns() const { return false; }
  /// How many members the sets of all nodes with children have together.
  virtual void expect(std::uint64_t) {}
  virtual void see(const ChildBits&) {}
  virtual LengthStatistics statistics() const { return {}; }
  virtual void write_model(std::vector<std::byte>&) {}
  virtual void encode(const ChildBits&, std::vector<std::byte>& out) const = 0;
  virtual void read_model(ByteReader&) {}
  /// Fills node.bits (children * members of them) from exactly these bytes; FormatError otherwise.
  virtual void decode(std::span<const std::byte> part, ChildBits& node) const = 0;
};

/// The methods by name; null where the name is not one of a codec over a tree.
std::unique_ptr<NodeCoder> make_node_coder(std::string_view codec);
std::unique_ptr<NodeCoder> make_zach_coder(std::string_view codec);     // zach.cpp
std::unique_ptr<NodeCoder> make_gotsman_coder(std::string_view codec);  // gotsman.cpp

/// Payload: one byte that says whether everything is in the root's set; the model; then the parts in node order. The
/// root whose set is not everything is coded as the only child of a node whose set is.
Encoded encode_over_tree(NodeCoder& coder, const VisibilityMatrix& matrix, const ObjectTree* tree);

/// For the tables: zeros where the codec codes no lengths. Throws as its encode does.
LengthStatistics length_statistics(const Codec& codec, const VisibilityMatrix& matrix,
                                   const ObjectTree* tree);

/// The sets on the way from the root to the node asked for last. A caller's own, one a thread.
struct NodePath {
  std::vector<NodeSet> sets;
};

/// Reads one node without the rest: what a client does that pages nodes in. Thread-safe once made.
class NodeReader {
 public:
  /// Borrows the bytes and the tree. Reads the model and the index, O(nodes). Throws as Codec::decode does.
  NodeReader(std::string_view codec, std::span<const std::byte> payload,
             std::span<const std::byte> node_index, Shape shape, const ObjectTree& tree);

  TreeOver side() const { return coder_->side(); }
  /// O(rows) over a tree of columns, else O(columns).
  NodeSet root() const;
  /// The sets of the node's children, given its own. Reads this node's part alone: O(children * members).
  std::vector<NodeSet> children(const NodeSet& set) const;
  /// The set of any node, by the path from the root: reads depth parts.
  NodeSet set(std::uint32_t node) const;
  /// The same, but what `path` shares of the way is not read again. Valid until the path is used again.
  const NodeSet& set(std::uint32_t node, NodePath& path) const;
  /// Over a tree of rows, the node that is row `row`. Throws std::out_of_range for a row that is none.
  std::uint32_t node_of_row(std::uint32_t row) const { return node_of_row_.at(row); }
  /// Bytes of the payload that children(node) reads; 0 for a leaf.
  std::uint64_t part_bytes(std::uint32_t node) const { return part_of_node_[node].size(); }
  /// What set(node) reads of the payload, from how many parts.
  struct Cost {
    std::uint64_t bytes = 0, parts = 0;
  };
  Cost cost(std::uint32_t node) const;
  /// The model and the byte before it, read once when opened.
  std::uint64_t model_bytes() const { return model_bytes_; }

 private:
  std::uint32_t universe_ = 0;
  const ObjectTree* tree_;
  std::unique_ptr<NodeCoder> coder_;
  bool root_everything_ = true;
  std::uint64_t model_bytes_ = 0;
  std::span<const std::byte> root_part_;
  std::vector<std::span<const std::byte>> part_of_node_;
  std::vector<std::uint32_t> leafs_of_node_, node_of_row_;
};

VisibilityMatrix decode_over_tree(std::string_view codec, std::span<const std::byte> payload,
                                  std::span<const std::byte> node_index, Shape shape, const ObjectTree* tree);

}  // namespace vismat
