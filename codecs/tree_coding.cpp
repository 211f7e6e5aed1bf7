// ALGORITHM [Zach & Karner 2003, sections 3, 4.3 and Figure 1]. The matrix is read by columns: v(A), the
// cells that see node A. A child is visible only where its parent is, so its bits are kept for the parent's
// cells alone and the rest is implied. Each node with children makes one part; parts end on whole bytes,
// which costs half a byte a node (0.1 % on the artificial sets) and lets a client keep each part in its node.
#include "codecs/tree_coding.h"

#include <algorithm>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>

#include "codecs/bit_stream.h"

namespace vismat {
namespace {

constexpr const char* not_monotone =
    "the matrix is not monotone over its tree: some node is hidden where its child is visible";

// Marks where the cells of a part stand among those of the whole.
class Marker {
 public:
  explicit Marker(std::uint32_t cells) : place_(cells, 0) {}
  void begin(std::span<const std::uint32_t> whole) {
    whole_ = whole;
    for (std::uint32_t p = 0; p < whole.size(); ++p) place_[whole[p]] = p;
  }
  // std::invalid_argument where the part holds a cell that the whole has not.
  void mark(std::span<const std::uint32_t> part, std::uint8_t* bits) const {
    std::fill_n(bits, whole_.size(), std::uint8_t{0});
    for (const std::uint32_t cell : part) {
      const std::uint32_t p = place_[cell];
      if (p >= whole_.size() || whole_[p] != cell) throw std::invalid_argument(not_monotone);
      bits[p] = 1;
    }
  }

 private:
  std::vector<std::uint32_t> place_;  // what others left there is found out by looking back
  std::span<const std::uint32_t> whole_;
};

std::vector<std::uint32_t> marked(std::span<const std::uint32_t> whole, const std::uint8_t* bits) {
  std::vector<std::uint32_t> part(whole.size());
  std::size_t count = 0;
  for (std::size_t p = 0; p < whole.size(); ++p) {
    part[count] = whole[p];
    count += bits[p];
  }
  part.resize(count);
  return part;
}

// 2^31 bits of one node are 2 GB here; a hostile tree and shape could ask for 2^64.
std::size_t checked_size(std::size_t children, std::size_t cells) {
  if (cells != 0 && children > (std::size_t{1} << 31) / cells) {
    throw FormatError(std::to_string(children) + " children seen from " + std::to_string(cells) +
                      " cells are too many for one node; at most 2^31 pairs");
  }
  return children * cells;
}

std::vector<std::uint32_t> every_cell(std::uint32_t rows) {
  std::vector<std::uint32_t> cells(rows);
  std::iota(cells.begin(), cells.end(), 0u);
  return cells;
}

// Calls visit(ChildBits) for the root, where not every cell sees it, and then for each node that has
// children. Throws std::invalid_argument where the matrix is not monotone over the tree.
template <typename Visit>
void for_each_node(const VisibilityMatrix& cells_of_node, const ObjectTree& tree, const Visit& visit) {
  const std::uint32_t rows = cells_of_node.shape().columns;
  ChildBits node;
  Marker marker(rows);
  const auto begin = [&](std::span<const std::uint32_t> cells, std::size_t children) {
    node.children = static_cast<std::uint32_t>(children);
    node.cells = static_cast<std::uint32_t>(cells.size());
    node.bits.resize(checked_size(node.children, node.cells));
    marker.begin(cells);
  };
  if (tree.size() > 0 && cells_of_node.row(0).size() < rows) {
    const auto all = every_cell(rows);
    begin(all, 1);
    marker.mark(cells_of_node.row(0), node.bits.data());
    visit(node);
  }
  for (std::uint32_t n = 0; n < tree.size(); ++n) {
    const auto children = tree.children(n);
    if (children.empty()) continue;
    begin(cells_of_node.row(n), children.size());
    for (std::size_t i = 0; i < children.size(); ++i)
      marker.mark(cells_of_node.row(children[i]), node.bits.data() + i * node.cells);
    visit(node);
  }
}

void check_fit(const VisibilityMatrix& matrix, const ObjectTree* tree) {
  if (tree == nullptr)
    throw std::invalid_argument("this codec needs a tree over the columns; make one with 'vismat tree'");
  if (tree->size() != matrix.shape().columns) {
    throw std::invalid_argument("the tree has " + std::to_string(tree->size()) +
                                " nodes but the matrix has " + std::to_string(matrix.shape().columns) +
                                " columns; this codec needs one column a node ('vismat tree --nodes')");
  }
}

}  // namespace

Encoded encode_over_tree(NodeCoder& coder, const VisibilityMatrix& matrix, const ObjectTree* tree) {
  check_fit(matrix, tree);
  const VisibilityMatrix cells_of_node = transpose(matrix);
  if (coder.learns()) for_each_node(cells_of_node, *tree, [&](const ChildBits& node) { coder.see(node); });

  Encoded out;
  const bool root_everywhere = tree->size() == 0 || cells_of_node.row(0).size() == matrix.shape().rows;
  out.payload.push_back(static_cast<std::byte>(root_everywhere));
  coder.write_model(out.payload);
  for_each_node(cells_of_node, *tree, [&](const ChildBits& node) {
    const std::size_t before = out.payload.size();
    coder.encode(node, out.payload);
    put_varint(out.index, out.payload.size() - before);
  });
  return out;
}

LengthStatistics length_statistics(const Codec& codec, const VisibilityMatrix& matrix,
                                   const ObjectTree* tree) {
  const auto coder = make_node_coder(codec.name);
  if (!coder) return {};
  check_fit(matrix, tree);
  for_each_node(transpose(matrix), *tree, [&](const ChildBits& node) { coder->see(node); });
  return coder->statistics();
}

NodeReader::NodeReader(std::string_view codec, std::span<const std::byte> payload,
                       std::span<const std::byte> node_index, Shape shape, const ObjectTree& tree)
    : shape_(shape), tree_(&tree), coder_(make_node_coder(codec)), part_of_node_(tree.size()) {
  if (!coder_)
    throw std::invalid_argument(std::string(codec) + " is no codec over a tree; it cannot read single nodes");
  if (tree.size() != shape.columns) {
    throw FormatError("the tree has " + std::to_string(tree.size()) + " nodes for " +
                      std::to_string(shape.columns) + " columns");
  }
  ByteReader in(payload, "payload"), index(node_index, "node index");
  const auto flag = in.number<std::uint8_t>();
  if (flag > 1) in.fail("the root's flag is " + std::to_string(flag) + "; it must be 0 or 1");
  root_everywhere_ = flag == 1;
  coder_->read_model(in);
  if (!root_everywhere_ && tree.size() > 0) root_part_ = in.bytes(index.varint());
  for (std::uint32_t n = 0; n < tree.size(); ++n) {
    if (!tree.children(n).empty()) part_of_node_[n] = in.bytes(index.varint());
  }
  if (in.left() != 0) in.fail(std::to_string(in.left()) + " bytes more than the node index accounts for");
  if (index.left() != 0)
    index.fail(std::to_string(index.left()) + " bytes more than the tree has nodes with children");
}

std::vector<std::uint32_t> NodeReader::root_cells() const {
  auto all = every_cell(shape_.rows);
  if (root_everywhere_) return all;
  ChildBits node{1, shape_.rows, std::vector<std::uint8_t>(shape_.rows)};
  coder_->decode(root_part_, node);
  return marked(all, node.bits.data());
}

std::vector<std::vector<std::uint32_t>> NodeReader::children(std::uint32_t node,
                                                             std::span<const std::uint32_t> cells) const {
  ChildBits bits{
      static_cast<std::uint32_t>(tree_->children(node).size()), static_cast<std::uint32_t>(cells.size()), {}};
  std::vector<std::vector<std::uint32_t>> out;
  if (bits.children == 0) return out;
  try {
    bits.bits.resize(checked_size(bits.children, bits.cells));
    coder_->decode(part_of_node_[node], bits);
  } catch (const FormatError& error) {
    throw FormatError("node " + std::to_string(node) + ": " + error.what());
  }
  for (std::uint32_t i = 0; i < bits.children; ++i)
    out.push_back(marked(cells, bits.bits.data() + std::size_t{i} * bits.cells));
  return out;
}

std::vector<std::uint32_t> NodeReader::cells(std::uint32_t node) const {
  std::vector<std::uint32_t> path;
  for (std::uint32_t n = node; n != 0; n = tree_->parent_of_node()[n]) path.push_back(n);
  std::vector<std::uint32_t> cells = root_cells();
  for (std::uint32_t from = 0; !path.empty(); from = path.back(), path.pop_back()) {
    const auto siblings = tree_->children(from);
    const auto place = std::find(siblings.begin(), siblings.end(), path.back()) - siblings.begin();
    cells = std::move(children(from, cells)[static_cast<std::size_t>(place)]);
  }
  return cells;
}

VisibilityMatrix decode_over_tree(std::string_view codec, std::span<const std::byte> payload,
                                  std::span<const std::byte> node_index, Shape shape,
                                  const ObjectTree* tree) {
  if (tree == nullptr) throw FormatError("the payload of " + std::string(codec) + " needs its tree");
  const NodeReader reader(codec, payload, node_index, shape, *tree);
  std::vector<std::vector<std::uint32_t>> cells_of_node(tree->size());
  if (tree->size() > 0) cells_of_node[0] = reader.root_cells();
  for (std::uint32_t n = 0; n < tree->size(); ++n) {
    auto sets = reader.children(n, cells_of_node[n]);
    for (std::size_t i = 0; i < sets.size(); ++i) cells_of_node[tree->children(n)[i]] = std::move(sets[i]);
  }
  return transpose(VisibilityMatrix::from_rows(cells_of_node, shape.rows));
}

}  // namespace vismat
