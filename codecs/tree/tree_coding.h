// What the tree codecs share: sets on a tree, each node's inside its parent's. Over a tree of objects (columns) a
// node's set is the rows (view cells) that see it [Zach & Karner 2003]. Over a tree of view cells (rows) it is the
// columns (objects) that some row below the node sees [Gotsman et al. 1999]. Each node stores which members of its set
// are in its children's sets.
#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "codecs/codec.h"
#include "codecs/vmat/parts.h"
#include "codecs/vmat/row_source.h"

namespace vismat {

/// One node's set, with what a reader knows after decoding the path from the root.
struct NodeSet {
  std::uint32_t node = 0;
  std::vector<std::uint32_t> members;  // ascending
  /// The history of each member, for coders that ask for it (NodeCoder::wants_history); otherwise empty. Bit i of a
  /// history, i < 8, says whether the sibling of the node's i-th ancestor has the member, the node being its own 0-th
  /// ancestor. Two members are of one kind if their whole histories agree up to the root; kinds are numbered in the
  /// order of their first members.
  std::vector<std::uint8_t> history;
  std::vector<std::uint32_t> kind;
};

/// One node's children over the members of its set: child i has the p-th member if bits[i * members + p] is 1. One byte
/// for each bit: at most a few hundred kB exist at a time, and the loops stay plain.
struct ChildBits {
  std::uint32_t children = 0, members = 0;
  std::vector<std::uint8_t> bits;
  std::vector<std::uint8_t> memory;  // a decoder's own, kept from node to node
  // Writer and reader both know the following from the tree and the path from the root.
  const NodeSet* set = nullptr;  // of the node itself
  std::uint32_t universe = 0;    // members are below this
  std::uint32_t leafs = 0;       // of the tree below the node
  bool first_child = false;      // the node is its parent's first
  /// Whether this is the node above the root, whose set is everything and whose only child is the root.
  bool of_root = false;

  std::span<const std::uint8_t> child(std::uint32_t i) const {
    return std::span(bits).subspan(std::size_t{i} * members, members);
  }
};

/// Statistics of a method that codes lengths: `bits` bits cut into `lengths` lengths, and what an ideal arithmetic
/// coder with the one histogram of their symbols would need for them, raw bits included.
struct LengthStatistics {
  std::uint64_t bits = 0, lengths = 0;
  double entropy_bytes = 0;
};

/// How a method codes one node's ChildBits. The calls come in this order: expect; see() for every node, if it learns();
/// write_model; encode.
class NodeCoder {
 public:
  virtual ~NodeCoder() = default;
  virtual bool wants_history() const { return false; }
  virtual bool learns() const { return false; }
  /// The number of members that the sets of all nodes with children have together.
  virtual void expect(std::uint64_t, const EncodeOptions&) {}
  virtual void see(const ChildBits&) {}
  virtual LengthStatistics statistics() const { return {}; }
  virtual void write_model(std::vector<std::byte>&) {}
  virtual void encode(const ChildBits&, std::vector<std::byte>& out) const = 0;
  virtual void read_model(ByteReader&) {}
  /// Fills node.bits (children * members of them) from exactly these bytes. Throws FormatError on others.
  virtual void decode(std::span<const std::byte> part, ChildBits& node) const = 0;
};

/// The payload is one byte that says whether everything is in the root's set; the model; then the parts in node order.
/// A root whose set is not everything is coded as the only child of a node whose set is. A tree of rows is binary, with
/// each row in one leaf, and a node's set is the union of its two children's.
Encoded encode_over_tree(NodeCoder& coder, TreeOver over, const VisibilityMatrix& matrix, const Side& side,
                         const EncodeOptions& options);

/// For tables; zeros if the codec codes no lengths. Throws what the codec's encode throws.
LengthStatistics length_statistics(const Codec& codec, const VisibilityMatrix& matrix,
                                   const ObjectTree* tree);

/// The sets on the path from the root to the node that was asked for last, and the memory for decoding them. Each
/// caller and thread has its own; any reader may use it.
class NodePath {
 public:
  /// The set of the node that was asked for last. There must be one.
  const NodeSet& last() const { return sets_[depth_ - 1]; }

 private:
  friend class NodeReader;
  std::shared_ptr<const void> reader_;  // the reader whose sets these are
  std::vector<NodeSet> sets_;
  std::size_t depth_ = 0;  // how many of them
  ChildBits bits_;
  std::vector<std::uint32_t> way_, kind_of_;
};

/// Reads one node without the rest, as a client that pages nodes in does. Thread-safe once made.
class NodeReader {
 public:
  /// `codec` must be a tree codec. Borrows the bytes and the tree. Reads the model, O(nodes). Throws FormatError as
  /// Codec::decode does, std::invalid_argument for another codec.
  NodeReader(const Codec& codec, Parts parts, Shape shape, const ObjectTree& tree);
  NodeReader(std::unique_ptr<NodeCoder> coder, TreeOver over, Parts parts, Shape shape,
             const ObjectTree& tree);
  /// The set of the root. O(rows) over a tree of columns, otherwise O(columns).
  NodeSet root() const;
  /// The sets of the node's children, given its own set. Reads only this node's part: O(children * members).
  std::vector<NodeSet> children(const NodeSet& set) const;
  /// The set of any node, by the path from the root: reads as many parts as the node is deep.
  NodeSet set(std::uint32_t node) const;
  /// The same, but what `path` already has of the path is not read again, and nothing is allocated once it has held the
  /// largest sets. Valid until the path is used again.
  const NodeSet& set(std::uint32_t node, NodePath& path) const;
  /// The node that is row `row`, over a tree of rows. Throws std::out_of_range for a row that does not exist.
  std::uint32_t node_of_row(std::uint32_t row) const { return node_of_row_.at(row); }
  /// The bytes of the payload that children(node) reads; 0 for a leaf.
  std::uint64_t part_bytes(std::uint32_t node) const {
    return part_of_node_[node] == no_part ? 0 : parts_.part_bytes(part_of_node_[node]);
  }
  /// What set(node) reads of the payload, and from how many parts.
  RowSource::Cost cost(std::uint32_t node) const;
  /// The bytes of the model and of the byte before it, which are read once at the opening.
  std::uint64_t model_bytes() const { return model_bytes_; }

 private:
  static constexpr std::uint32_t no_part = 0xffffffff;
  void read_root(NodeSet& root, ChildBits& bits) const;
  void read_children(const NodeSet& set, ChildBits& bits) const;
  void take_child(const NodeSet& set, const ChildBits& bits, std::uint32_t child, std::uint32_t node,
                  NodeSet& out, std::vector<std::uint32_t>& kind_of) const;
  std::shared_ptr<const void> self_ = std::make_shared<char>();  // identifies this reader to a NodePath
  std::uint32_t universe_ = 0;
  const ObjectTree* tree_;
  std::unique_ptr<NodeCoder> coder_;
  Parts parts_;
  bool root_everything_ = true;
  std::uint64_t model_bytes_ = 0;
  std::vector<std::uint32_t> part_of_node_, leafs_of_node_, node_of_row_;
};

VisibilityMatrix decode_over_tree(std::unique_ptr<NodeCoder> coder, TreeOver over, const Parts& parts,
                                  Shape shape, const Side& side, std::uint64_t most);
/// The rows of a payload over a tree of rows, each by the path to its leaf.
std::unique_ptr<const RowSource> open_over_tree(std::unique_ptr<NodeCoder> coder, Parts parts, Shape shape,
                                                const Side& side);

/// A line of the table for a method, which is a NodeCoder.
template <typename Coder, TreeOver over>
constexpr Codec tree_codec(std::string_view name, std::string_view contents, Origin origin) {
  Codec codec{.name = name, .contents = contents, .origin = origin};
  codec.needs.tree = over;
  codec.encode = [](const VisibilityMatrix& matrix, const Side& side, const EncodeOptions& options) {
    Coder coder;
    return encode_over_tree(coder, over, matrix, side, options);
  };
  codec.decode = [](const Parts& parts, Shape shape, const Side& side, std::uint64_t most) {
    return decode_over_tree(std::make_unique<Coder>(), over, parts, shape, side, most);
  };
  if constexpr (over == TreeOver::rows) {
    codec.open = [](Parts parts, Shape shape, const Side& side) {
      return open_over_tree(std::make_unique<Coder>(), std::move(parts), shape, side);
    };
  }
  codec.node_coder = []() -> std::unique_ptr<NodeCoder> { return std::make_unique<Coder>(); };
  return codec;
}

/// Zach and Karner's methods (zach.cpp); Gotsman's methods and ours under contexts (gotsman.cpp).
std::span<const Codec> zach_codecs();
std::span<const Codec> gotsman_codecs();

}  // namespace vismat
