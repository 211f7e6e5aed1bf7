// Sets on a tree, each node's inside its parent's: what the codecs over a tree share. Over a tree of columns a node's set is
// the rows (view cells) that see it [Zach & Karner 2003]; over a tree of rows it is the columns (objects) that some row below
// the node sees [Gotsman et al. 1999]. Each node stores which of its own set are in its children's.
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
  std::vector<std::uint8_t> memory;  // a decoder's own, kept from node to node
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
  virtual bool wants_history() const { return false; }
  virtual bool learns() const { return false; }
  /// How many members the sets of all nodes with children have together.
  virtual void expect(std::uint64_t, const EncodeOptions&) {}
  virtual void see(const ChildBits&) {}
  virtual LengthStatistics statistics() const { return {}; }
  virtual void write_model(std::vector<std::byte>&) {}
  virtual void encode(const ChildBits&, std::vector<std::byte>& out) const = 0;
  virtual void read_model(ByteReader&) {}
  /// Fills node.bits (children * members of them) from exactly these bytes; FormatError otherwise.
  virtual void decode(std::span<const std::byte> part, ChildBits& node) const = 0;
};

/// Payload: one byte that says whether everything is in the root's set; the model; then the parts in node order. The
/// root whose set is not everything is coded as the only child of a node whose set is. Over a tree of rows, which is binary with
/// each row in one leaf, a node's set is the union of its two children's.
Encoded encode_over_tree(NodeCoder& coder, TreeOver over, const VisibilityMatrix& matrix, const Side& side,
                         const EncodeOptions& options);

/// For the tables: zeros where the codec codes no lengths. Throws as its encode does.
LengthStatistics length_statistics(const Codec& codec, const VisibilityMatrix& matrix,
                                   const ObjectTree* tree);

/// The sets on the way from the root to the node asked for last, and what decoding them takes. A caller's own, one a thread;
/// any reader may use it.
class NodePath {
 public:
  /// Of the node asked for last; needs one.
  const NodeSet& last() const { return sets_[depth_ - 1]; }

 private:
  friend class NodeReader;
  std::shared_ptr<const void> reader_;  // whose sets these are
  std::vector<NodeSet> sets_;
  std::size_t depth_ = 0;  // how many of them
  ChildBits bits_;
  std::vector<std::uint32_t> way_, kind_of_;
};

/// Reads one node without the rest: what a client does that pages nodes in. Thread-safe once made.
class NodeReader {
 public:
  /// Of a codec over a tree. Borrows the bytes and the tree. Reads the model, O(nodes). Throws FormatError as Codec::decode does,
  /// std::invalid_argument for another codec.
  NodeReader(const Codec& codec, Parts parts, Shape shape, const ObjectTree& tree);
  NodeReader(std::unique_ptr<NodeCoder> coder, TreeOver over, Parts parts, Shape shape,
             const ObjectTree& tree);
  /// O(rows) over a tree of columns, else O(columns).
  NodeSet root() const;
  /// The sets of the node's children, given its own. Reads this node's part alone: O(children * members).
  std::vector<NodeSet> children(const NodeSet& set) const;
  /// The set of any node, by the path from the root: reads depth parts.
  NodeSet set(std::uint32_t node) const;
  /// The same, but what `path` shares of the way is not read again, and nothing is allocated once it has held the largest sets.
  /// Valid until the path is used again.
  const NodeSet& set(std::uint32_t node, NodePath& path) const;
  /// Over a tree of rows, the node that is row `row`. Throws std::out_of_range for a row that is none.
  std::uint32_t node_of_row(std::uint32_t row) const { return node_of_row_.at(row); }
  /// Bytes of the payload that children(node) reads; 0 for a leaf.
  std::uint64_t part_bytes(std::uint32_t node) const {
    return part_of_node_[node] == no_part ? 0 : parts_.part_bytes(part_of_node_[node]);
  }
  /// What set(node) reads of the payload, from how many parts.
  RowSource::Cost cost(std::uint32_t node) const;
  /// The model and the byte before it, read once when opened.
  std::uint64_t model_bytes() const { return model_bytes_; }

 private:
  static constexpr std::uint32_t no_part = 0xffffffff;
  void read_root(NodeSet& root, ChildBits& bits) const;
  void read_children(const NodeSet& set, ChildBits& bits) const;
  void take_child(const NodeSet& set, const ChildBits& bits, std::uint32_t child, std::uint32_t node,
                  NodeSet& out, std::vector<std::uint32_t>& kind_of) const;
  std::shared_ptr<const void> self_ = std::make_shared<char>();  // what a NodePath knows this reader by
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
/// Rows of a payload over a tree of rows: each by the way down to its leaf.
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

/// Zach and Karner's methods (zach.cpp), Gotsman's and ours under contexts (gotsman.cpp).
std::span<const Codec> zach_codecs();
std::span<const Codec> gotsman_codecs();

}  // namespace vismat
