// ALGORITHM [Zach & Karner 2003, sections 3, 4.3 and Figure 1; Gotsman et al. 1999]. The common part of the tree
// codecs. Each node has a set that contains its children's. Over a tree of objects it is v(A), the view cells that see
// node A, since a child is visible only where its parent is. Over a tree of view cells it is the objects that are seen
// from somewhere below. So a child's bits are stored for the members of its parent's set alone and the rest is implied.
// Each node with children makes one part. Parts end on whole bytes, which lets a client keep each part in its node.
//
// Along the path from the root a reader learns more than the node's own set: which members are in the siblings' sets on
// the way. That is kept as `history` and `kind` for coders that want it.
#include "codecs/tree/tree_coding.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>

#include "codecs/entropy/bit_stream.h"
#include "codecs/rows/pairs.h"

namespace vismat {
namespace {

constexpr const char* not_monotone =
    "the matrix is not monotone over its tree: some node is hidden where its child is visible";

// Marks where the members of a part stand among those of the whole.
class Marker {
 public:
  explicit Marker(std::uint32_t universe) : place_(universe, 0) {}
  void begin(std::span<const std::uint32_t> whole) {
    whole_ = whole;
    for (std::uint32_t p = 0; p < whole.size(); ++p) place_[whole[p]] = p;
  }
  // std::invalid_argument where the part has a member that the whole has not.
  void mark(std::span<const std::uint32_t> part, std::uint8_t* bits) const {
    std::fill_n(bits, whole_.size(), std::uint8_t{0});
    for (const std::uint32_t member : part) {
      const std::uint32_t p = place_[member];
      if (p >= whole_.size() || whole_[p] != member) throw std::invalid_argument(not_monotone);
      bits[p] = 1;
    }
  }

 private:
  std::vector<std::uint32_t> place_;  // what others left there is found out by looking back
  std::span<const std::uint32_t> whole_;
};

// `part` becomes those of the whole whose bit is 1.
void take_marked(std::span<const std::uint32_t> whole, std::span<const std::uint8_t> bits,
                 std::vector<std::uint32_t>& part) {
  part.resize(whole.size());
  std::size_t count = 0;
  for (std::size_t p = 0; p < whole.size(); ++p) {
    part[count] = whole[p];
    count += bits[p];
  }
  part.resize(count);
}

// A bit of one node takes a byte of memory. What a tree and a shape claim may be 2^64; a part's bytes back 2^16 each, and
// 2^28 go without. An encoder makes none that is refused.
std::string too_many_bits(std::size_t children, std::size_t members, std::size_t part_bytes) {
  const std::size_t most = std::min<std::size_t>(
      std::size_t{1} << 31, (std::size_t{1} << 28) + std::min<std::size_t>(part_bytes, 1 << 20) * 65536);
  if (members == 0 || children <= most / members) return {};
  return std::to_string(children) + " children over a set of " + std::to_string(members) +
         " are too many for one node; a part of " + std::to_string(part_bytes) + " bytes may have " +
         std::to_string(most) + " pairs at most";
}

void everything(std::uint32_t universe, std::vector<std::uint32_t>& all) {
  all.resize(universe);
  std::iota(all.begin(), all.end(), 0u);
}

// Gives a child's set its history, from its parent's and from the bits of both children.
void inherit(const NodeSet& parent, std::span<const std::uint8_t> own, std::span<const std::uint8_t> sibling,
             NodeSet& child, std::vector<std::uint32_t>& kind_of) {
  const std::size_t count = child.members.size();
  child.history.resize(count);
  child.kind.resize(count);
  constexpr std::uint32_t unseen = 0xffffffff;
  kind_of.assign(2 * parent.kind.size(), unseen);
  std::uint32_t kinds = 0;
  for (std::size_t p = 0, at = 0; p < own.size(); ++p) {
    if (own[p] == 0) continue;
    child.history[at] = static_cast<std::uint8_t>(parent.history[p] << 1 | sibling[p]);
    std::uint32_t& kind = kind_of[2 * parent.kind[p] + sibling[p]];
    if (kind == unseen) kind = kinds++;
    child.kind[at++] = kind;
  }
}

void begin_history(NodeSet& root) {
  root.history.assign(root.members.size(), 0);
  root.kind.assign(root.members.size(), 0);
}

std::vector<std::uint32_t> leafs_of_nodes(const ObjectTree& tree) {
  std::vector<std::uint32_t> leafs(tree.size(), 0);
  for (std::uint32_t n = tree.size(); n-- > 0;) {
    if (tree.children(n).empty()) leafs[n] = 1;
    if (n > 0) leafs[tree.parent_of_node()[n]] += leafs[n];
  }
  return leafs;
}

// What the tree tells of a node.
void place_in_tree(ChildBits& bits, const ObjectTree& tree, std::span<const std::uint32_t> leafs_of_node,
                   std::uint32_t node) {
  bits.leafs = leafs_of_node[node];
  bits.first_child = node > 0 && tree.children(tree.parent_of_node()[node])[0] == node;
}

// A word is written once for all of its ids: writing it for each would wait each time for the last.
void set_bits(std::span<const std::uint32_t> ids, std::span<std::uint64_t> words) {
  std::uint64_t bits = 0;
  std::size_t at = 0;
  for (const std::uint32_t id : ids) {
    if (id / 64 != at) {
      words[at] |= std::exchange(bits, 0);
      at = id / 64;
    }
    bits |= std::uint64_t{1} << id % 64;
  }
  if (bits != 0) words[at] |= bits;
}

// Each node's set. Of columns: a leaf's is its row, another's the union of its children's, which goes through a bit vector, or
// where that is mostly empty by merging.
class SetsOfNodes {
 public:
  // Borrows the matrix. Requires that the tree fits.
  SetsOfNodes(TreeOver side, const VisibilityMatrix& matrix, const ObjectTree& tree)
      : universe_(side == TreeOver::columns ? matrix.shape().rows : matrix.shape().columns),
        set_of_node_(tree.size()) {
    if (side == TreeOver::columns) {
      columns_ = transpose(matrix);
      for (std::uint32_t n = 0; n < tree.size(); ++n) set_of_node_[n] = columns_.row(n);
      return;
    }
    unions_.resize(tree.size());
    std::vector<std::uint64_t> words((std::size_t{universe_} + 63) / 64, 0);
    std::vector<std::uint32_t> united(universe_);
    for (std::uint32_t n = tree.size(); n-- > 0;) {
      const auto children = tree.children(n);
      if (children.empty()) {
        set_of_node_[n] = matrix.row(tree.object_of_node()[n]);
        continue;
      }
      const auto first = set_of_node_[children[0]], second = set_of_node_[children[1]];
      auto* end = united.data();
      if (first.size() + second.size() < words.size() / 2) {
        end = std::set_union(first.begin(), first.end(), second.begin(), second.end(), end);
      } else {
        set_bits(first, words);
        set_bits(second, words);
        for (std::size_t w = 0; w < words.size(); ++w) {
          for (std::uint64_t left = std::exchange(words[w], 0); left != 0; left &= left - 1)
            *end++ = static_cast<std::uint32_t>(64 * w) + static_cast<std::uint32_t>(std::countr_zero(left));
        }
      }
      unions_[n].assign(united.data(), end);
      set_of_node_[n] = unions_[n];
    }
  }
  SetsOfNodes(const SetsOfNodes&) = delete;
  SetsOfNodes& operator=(const SetsOfNodes&) = delete;

  std::uint32_t universe() const { return universe_; }
  std::span<const std::uint32_t> operator[](std::uint32_t node) const { return set_of_node_[node]; }

 private:
  std::uint32_t universe_;
  VisibilityMatrix columns_;
  std::vector<std::vector<std::uint32_t>> unions_;  // of nodes with children
  std::vector<std::span<const std::uint32_t>> set_of_node_;
};

// Calls visit(ChildBits) for the root, where its set is not everything, and then for each node that has
// children. Throws std::invalid_argument where the sets are not monotone over the tree.
template <typename Visit>
void for_each_node(const SetsOfNodes& sets, const ObjectTree& tree, bool history, const Visit& visit) {
  ChildBits bits;
  bits.universe = sets.universe();
  Marker marker(bits.universe);
  const auto begin = [&](const NodeSet& set, std::size_t children) {
    bits.set = &set;
    bits.children = static_cast<std::uint32_t>(children);
    bits.members = static_cast<std::uint32_t>(set.members.size());
    if (const std::string wrong = too_many_bits(children, set.members.size(), ~std::size_t{0});
        !wrong.empty())
      throw std::invalid_argument(wrong);
    bits.bits.resize(children * set.members.size());
    marker.begin(set.members);
  };
  if (tree.size() > 0 && sets[0].size() < bits.universe) {
    NodeSet all;
    everything(bits.universe, all.members);
    begin(all, 1);
    marker.mark(sets[0], bits.bits.data());
    bits.of_root = true;
    visit(bits);
    bits.of_root = false;
  }
  const std::vector<std::uint32_t> leafs_of_node = leafs_of_nodes(tree);
  std::vector<NodeSet> reached(history ? tree.size()
                                       : 0);  // with histories, from its parent's turn to its own
  if (!reached.empty()) {
    reached[0].members.assign(sets[0].begin(), sets[0].end());
    begin_history(reached[0]);
  }
  NodeSet set;
  std::vector<std::uint32_t> kind_of;
  for (std::uint32_t n = 0; n < tree.size(); ++n) {
    const auto children = tree.children(n);
    if (history) set = std::exchange(reached[n], {});
    if (children.empty()) continue;
    set.node = n;
    set.members.assign(sets[n].begin(), sets[n].end());
    begin(set, children.size());
    for (std::uint32_t i = 0; i < children.size(); ++i)
      marker.mark(sets[children[i]], bits.bits.data() + std::size_t{i} * bits.members);
    place_in_tree(bits, tree, leafs_of_node, n);
    visit(bits);
    for (std::uint32_t i = 0; history && i < children.size(); ++i) {
      if (tree.children(children[i]).empty()) continue;
      NodeSet& child = reached[children[i]];
      child.members.resize(sets[children[i]].size());
      inherit(set, bits.child(i), bits.child(1 - i), child, kind_of);
    }
  }
}

// What is wrong with a tree over the columns or the rows; empty where nothing is.
std::string misfit(TreeOver side, const ObjectTree& tree, Shape shape) {
  const std::string nodes = std::to_string(tree.size());
  if (side == TreeOver::columns) {
    if (tree.size() == shape.columns) return {};
    return "the tree has " + nodes + " nodes but the matrix has " + std::to_string(shape.columns) +
           " columns; this codec needs one column a node ('vismat tree --nodes')";
  }
  if (tree.object_count() != shape.rows) {
    return "the tree over the rows has " + std::to_string(tree.object_count()) +
           " objects but the matrix has " + std::to_string(shape.rows) + " rows";
  }
  std::vector<bool> told(shape.rows, false);
  for (std::uint32_t n = 0; n < tree.size(); ++n) {
    const std::uint32_t row = tree.object_of_node()[n];
    const std::size_t children = tree.children(n).size();
    const std::string node = "the tree over the rows: node " + std::to_string(n);
    if (children != 0 && children != 2) {
      return node + " has " + std::to_string(children) +
             " children; this codec needs two everywhere ('vismat tree --side rows')";
    }
    if ((children == 0) != (row != ObjectTree::none))
      return node + (children == 0 ? " is a leaf without a row" : " has children and a row");
    if (row == ObjectTree::none) continue;
    if (told[row]) return node + " holds row " + std::to_string(row) + ", as another does";
    told[row] = true;
  }
  for (std::uint32_t r = 0; r < shape.rows; ++r) {
    if (!told[r]) return "the tree over the rows: no leaf holds row " + std::to_string(r);
  }
  return {};
}

// Rows or columns that the sets are of take memory though no byte stands for each.
bool backed(std::uint32_t universe, const ObjectTree& tree, std::uint64_t payload_bytes) {
  return universe <= (std::uint64_t{1} << 24) + 4096 * (payload_bytes + tree.size());
}

void check_fit(TreeOver side, const VisibilityMatrix& matrix, const ObjectTree* tree) {
  if (tree == nullptr) {
    throw std::invalid_argument(
        side == TreeOver::columns
            ? "this codec needs a tree over the columns; make one with 'vismat tree'"
            : "this codec needs a tree over the rows; make one with 'vismat tree --side rows'");
  }
  if (const std::string wrong = misfit(side, *tree, matrix.shape()); !wrong.empty())
    throw std::invalid_argument(wrong);
}

}  // namespace

Encoded encode_over_tree(NodeCoder& coder, TreeOver over, const VisibilityMatrix& matrix, const Side& side,
                         const EncodeOptions& options) {
  check_fit(over, matrix, side.tree);
  const ObjectTree& tree = *side.tree;
  const SetsOfNodes sets(over, matrix, tree);
  const std::uint64_t passes = coder.learns() ? 2 : 1, total = passes * tree.size();
  const auto tell = [&](std::uint64_t pass, const ChildBits& node) {
    if (options.progress && node.set->node % 64 == 0)
      options.progress(pass * tree.size() + node.set->node, total);
  };
  if (coder.learns()) {
    std::uint64_t members = 0;
    for (std::uint32_t n = 0; n < tree.size(); ++n) members += tree.children(n).empty() ? 0 : sets[n].size();
    coder.expect(members, options);
    for_each_node(sets, tree, coder.wants_history(), [&](const ChildBits& node) {
      coder.see(node);
      tell(0, node);
    });
  }
  Encoded out;
  const bool root_everything = tree.size() == 0 || sets[0].size() == sets.universe();
  out.payload.push_back(static_cast<std::byte>(root_everything));
  coder.write_model(out.payload);
  std::vector<std::uint64_t> starts;
  for_each_node(sets, tree, coder.wants_history(), [&](const ChildBits& node) {
    starts.push_back(out.payload.size());
    coder.encode(node, out.payload);
    if (const std::string wrong =
            too_many_bits(node.children, node.members, out.payload.size() - starts.back());
        !wrong.empty())
      throw std::invalid_argument(wrong);
    tell(passes - 1, node);
  });
  if (!backed(sets.universe(), tree, out.payload.size())) {
    throw std::invalid_argument(std::to_string(sets.universe()) + " rows or columns in " +
                                std::to_string(out.payload.size()) + " bytes over a tree of " +
                                std::to_string(tree.size()) + " nodes; readers refuse so many in so few");
  }
  out.index = part_index_bytes(starts, out.payload.size());
  if (options.progress) options.progress(total, total);
  return out;
}

LengthStatistics length_statistics(const Codec& codec, const VisibilityMatrix& matrix,
                                   const ObjectTree* tree) {
  if (codec.node_coder == nullptr) return {};
  const auto coder = codec.node_coder();
  check_fit(codec.needs.tree, matrix, tree);
  for_each_node(SetsOfNodes(codec.needs.tree, matrix, *tree), *tree, coder->wants_history(),
                [&](const ChildBits& node) { coder->see(node); });
  return coder->statistics();
}

namespace {

std::unique_ptr<NodeCoder> coder_of(const Codec& codec) {
  if (codec.node_coder == nullptr)
    throw std::invalid_argument(std::string(codec.name) +
                                " is no codec over a tree; it cannot read single nodes");
  return codec.node_coder();
}

}  // namespace

NodeReader::NodeReader(const Codec& codec, Parts parts, Shape shape, const ObjectTree& tree)
    : NodeReader(coder_of(codec), codec.needs.tree, std::move(parts), shape, tree) {}

NodeReader::NodeReader(std::unique_ptr<NodeCoder> coder, TreeOver over, Parts parts, Shape shape,
                       const ObjectTree& tree)
    : tree_(&tree), coder_(std::move(coder)), parts_(std::move(parts)), part_of_node_(tree.size(), no_part) {
  if (const std::string wrong = misfit(over, tree, shape); !wrong.empty()) throw FormatError(wrong);
  universe_ = over == TreeOver::columns ? shape.rows : shape.columns;
  if (!backed(universe_, tree, parts_.payload_bytes())) {
    throw FormatError("claims " + std::to_string(universe_) +
                      (over == TreeOver::columns ? " rows" : " columns") + " for " +
                      std::to_string(parts_.payload_bytes()) + " bytes over a tree of " +
                      std::to_string(tree.size()) + " nodes");
  }
  leafs_of_node_ = leafs_of_nodes(tree);
  if (over == TreeOver::rows) {
    node_of_row_.resize(shape.rows);
    for (std::uint32_t n = 0; n < tree.size(); ++n) {
      if (tree.children(n).empty()) node_of_row_[tree.object_of_node()[n]] = n;
    }
  }
  parts_.expect_no_sections();
  const auto model = parts_.model();
  ByteReader in(model, "payload");
  const auto flag = in.number<std::uint8_t>();
  if (flag > 1) in.fail("the root's flag is " + std::to_string(flag) + "; it must be 0 or 1");
  root_everything_ = flag == 1;
  coder_->read_model(in);
  if (in.left() != 0) in.fail(std::to_string(in.left()) + " bytes after the model");
  model_bytes_ = model.size();
  std::uint32_t part = root_everything_ || tree.size() == 0 ? 0 : 1;  // the root's own comes first
  for (std::uint32_t n = 0; n < tree.size(); ++n) {
    if (!tree.children(n).empty()) part_of_node_[n] = part++;
  }
  parts_.expect(part);
}

void NodeReader::read_root(NodeSet& root, ChildBits& bits) const {
  root.node = 0;
  everything(universe_, root.members);
  if (!root_everything_) {
    bits.children = 1;
    bits.members = bits.universe = universe_;
    bits.bits.assign(universe_, 0);
    bits.set = &root;
    bits.of_root = true;
    coder_->decode(parts_.part(0), bits);
    bits.of_root = false;
    std::size_t count = 0;
    for (std::uint32_t p = 0; p < universe_; ++p) {
      root.members[count] = p;
      count += bits.bits[p];
    }
    root.members.resize(count);
  }
  if (coder_->wants_history()) begin_history(root);
}

void NodeReader::read_children(const NodeSet& set, ChildBits& bits) const {
  bits.of_root = false;  // a damaged root may have left it so
  assert(!coder_->wants_history() || set.history.size() == set.members.size());
  bits.children = static_cast<std::uint32_t>(tree_->children(set.node).size());
  bits.members = static_cast<std::uint32_t>(set.members.size());
  bits.set = &set;
  bits.universe = universe_;
  place_in_tree(bits, *tree_, leafs_of_node_, set.node);
  try {
    const auto part = parts_.part(part_of_node_[set.node]);
    if (const std::string wrong = too_many_bits(bits.children, bits.members, part.size()); !wrong.empty())
      throw FormatError(wrong);
    bits.bits.assign(std::size_t{bits.children} * bits.members, 0);
    coder_->decode(part, bits);
  } catch (const FormatError& error) {
    throw FormatError("node " + std::to_string(set.node) + ": " + error.what());
  }
}

void NodeReader::take_child(const NodeSet& set, const ChildBits& bits, std::uint32_t child,
                            std::uint32_t node, NodeSet& out, std::vector<std::uint32_t>& kind_of) const {
  out.node = node;
  take_marked(set.members, bits.child(child), out.members);
  out.history.clear();
  out.kind.clear();
  if (coder_->wants_history() && !tree_->children(node).empty())
    inherit(set, bits.child(child), bits.child(1 - child), out, kind_of);
}

NodeSet NodeReader::root() const {
  NodeSet root;
  ChildBits bits;
  read_root(root, bits);
  return root;
}

std::vector<NodeSet> NodeReader::children(const NodeSet& set) const {
  const auto nodes = tree_->children(set.node);
  std::vector<NodeSet> out(nodes.size());
  if (nodes.empty()) return out;
  ChildBits bits;
  std::vector<std::uint32_t> kind_of;
  read_children(set, bits);
  for (std::uint32_t i = 0; i < bits.children; ++i) take_child(set, bits, i, nodes[i], out[i], kind_of);
  return out;
}

NodeSet NodeReader::set(std::uint32_t node) const {
  NodePath path;
  set(node, path);
  return std::move(path.sets_[path.depth_ - 1]);
}

const NodeSet& NodeReader::set(std::uint32_t node, NodePath& path) const {
  auto& [reader, sets, depth, bits, way, kind_of] = path;
  if (reader != self_) {
    reader = self_;
    depth = 0;
  }
  way.clear();  // from the node up to the root
  for (std::uint32_t n = node; n != ObjectTree::none; n = tree_->parent_of_node()[n]) way.push_back(n);
  std::reverse(way.begin(), way.end());
  if (sets.size() < way.size()) sets.resize(way.size());
  std::size_t shared = 0;
  while (shared < std::min(way.size(), depth) && sets[shared].node == way[shared]) ++shared;
  depth = shared;  // what a damaged part leaves half done does not count
  if (depth == 0) {
    read_root(sets[0], bits);
    depth = 1;
  }
  for (; depth < way.size(); ++depth) {
    const NodeSet& parent = sets[depth - 1];
    const auto siblings = tree_->children(parent.node);
    const auto place = std::find(siblings.begin(), siblings.end(), way[depth]) - siblings.begin();
    read_children(parent, bits);
    take_child(parent, bits, static_cast<std::uint32_t>(place), way[depth], sets[depth], kind_of);
  }
  return sets[depth - 1];
}

RowSource::Cost NodeReader::cost(std::uint32_t node) const {
  RowSource::Cost cost;
  if (!root_everything_) cost = {parts_.part_bytes(0), 1};
  for (std::uint32_t n = node; n != 0; ++cost.parts) {
    n = tree_->parent_of_node()[n];
    cost.bytes += part_bytes(n);
  }
  return cost;
}

namespace {

const ObjectTree& tree_of(const Side& side) {
  if (side.tree == nullptr) throw FormatError("this payload needs its tree");
  return *side.tree;
}

class RowsOverTree final : public RowSource {
 public:
  RowsOverTree(std::unique_ptr<NodeCoder> coder, Parts parts, Shape shape, const ObjectTree& tree)
      : reader_(std::move(coder), TreeOver::rows, std::move(parts), shape, tree) {}
  void read(std::uint32_t row, RowScratch& scratch, IdSink& sink) const override { put(row, scratch, sink); }
  void read(std::uint32_t row, RowScratch& scratch, RunSink& sink) const override { put(row, scratch, sink); }
  void read(std::uint32_t row, RowScratch& scratch, BitSink& sink) const override { put(row, scratch, sink); }
  Cost cost(std::uint32_t row) const override { return reader_.cost(reader_.node_of_row(row)); }

 private:
  template <typename Sink>
  void put(std::uint32_t row, RowScratch& scratch, Sink& sink) const {
    const NodeSet& set = reader_.set(reader_.node_of_row(row), scratch.as<NodePath>());
    for_each_run(std::span<const std::uint32_t>(set.members),
                 [&](std::uint32_t first, std::uint32_t count) { sink.run(first - sink.next(), count); });
  }
  NodeReader reader_;
};

}  // namespace

std::unique_ptr<const RowSource> open_over_tree(std::unique_ptr<NodeCoder> coder, Parts parts, Shape shape,
                                                const Side& side) {
  return std::make_unique<RowsOverTree>(std::move(coder), std::move(parts), shape, tree_of(side));
}

// From the root down, each set once: by rows alone, those near the root would be read again and again.
VisibilityMatrix decode_over_tree(std::unique_ptr<NodeCoder> coder, TreeOver over, const Parts& parts,
                                  Shape shape, const Side& side, std::uint64_t most) {
  const ObjectTree& tree = tree_of(side);
  const NodeReader reader(std::move(coder), over, parts, shape, tree);
  const bool over_rows = over == TreeOver::rows;
  std::vector<NodeSet> reached(tree.size());
  std::vector<std::vector<std::uint32_t>> out(over_rows ? shape.rows : tree.size());
  std::uint64_t ones = 0;
  const auto put = [&](std::uint32_t place, std::vector<std::uint32_t>& ids) {
    if (ids.size() > most - ones) throw FormatError("more ones than the file states");
    ones += ids.size();
    out[place] = std::move(ids);
  };
  if (tree.size() > 0) reached[0] = reader.root();
  for (std::uint32_t n = 0; n < tree.size(); ++n) {
    NodeSet set = std::exchange(reached[n], {});
    for (NodeSet& child : reader.children(set)) reached[child.node] = std::move(child);
    if (!over_rows)
      put(n, set.members);
    else if (tree.children(n).empty())
      put(tree.object_of_node()[n], set.members);
  }
  return over_rows ? VisibilityMatrix::from_rows(out, shape.columns)
                   : transpose(VisibilityMatrix::from_rows(out, shape.rows));
}

}  // namespace vismat
