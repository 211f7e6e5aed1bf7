// ALGORITHM. The section that stores a tree: its shape and the objects of its nodes. Nodes are numbered level by level
// or, in the trees of game levels, branch by branch. Then the numbers of children, in the order of the nodes, determine
// the parents, in about a bit for each node of a binary tree. With any other numbering each node stores how far back
// its parent is. A node's object is either new, coded as a step from the last new one (steps.h), or one that came
// before, coded as the number of nodes with an object between.
#include <algorithm>
#include <array>
#include <bit>
#include <stdexcept>
#include <string>

#include "codecs/entropy/bit_stream.h"
#include "codecs/entropy/steps.h"
#include "codecs/vmat/sections.h"

namespace vismat {
namespace {

enum class Numbering : std::uint8_t { by_levels, by_branches, any };
constexpr std::uint8_t columns_are_nodes = 4;

// Parents out of the nodes' numbers of children, by either numbering. add(children) in the order of the nodes.
class Parents {
 public:
  Parents(Numbering numbering, std::size_t size) : numbering_(numbering) { parents_.reserve(size); }
  std::uint32_t next() const {
    if (parents_.empty()) return ObjectTree::none;
    return numbering_ == Numbering::by_levels ? open_[first_].node : open_.back().node;
  }
  /// Whether some node still waits for a child, or there is none yet.
  bool waits() const { return parents_.empty() || first_ < open_.size(); }
  void add(std::uint32_t children) {
    const auto node = static_cast<std::uint32_t>(parents_.size());
    parents_.push_back(next());
    if (node > 0) {
      if (numbering_ == Numbering::by_levels) {
        if (--open_[first_].left == 0) ++first_;
      } else if (--open_.back().left == 0) {
        open_.pop_back();
      }
    }
    if (children > 0) open_.push_back({node, children});
  }
  const std::vector<std::uint32_t>& parents() const { return parents_; }

 private:
  struct Open {
    std::uint32_t node, left;
  };
  Numbering numbering_;
  std::vector<std::uint32_t> parents_;
  std::vector<Open> open_;  // nodes that lack children; by branches a stack, by levels a queue from first_ on
  std::size_t first_ = 0;
};

bool numbered(const ObjectTree& tree, Numbering numbering) {
  Parents parents(numbering, tree.size());
  for (std::uint32_t n = 0; n < tree.size(); ++n) {
    if (!parents.waits()) return false;
    parents.add(static_cast<std::uint32_t>(tree.children(n).size()));
    if (parents.parents()[n] != tree.parent_of_node()[n]) return false;
  }
  return true;
}

Numbering numbering_of(const ObjectTree& tree) {
  for (const Numbering numbering : {Numbering::by_levels, Numbering::by_branches}) {
    if (numbered(tree, numbering)) return numbering;
  }
  return Numbering::any;
}

// Parents of `size` nodes; a writer's are those of the tree.
template <typename Coder>
std::vector<std::uint32_t> code_parents(Coder& coder, Numbering numbering, std::uint32_t size,
                                        const ObjectTree* tree) {
  if (numbering == Numbering::any) {
    std::array<AdaptiveNumber, 4> back;
    std::vector<std::uint32_t> parents;
    unsigned last = 0;
    for (std::uint32_t n = 0; n < size; ++n) {
      if (n == 0) {
        parents.push_back(ObjectTree::none);
        continue;
      }
      const std::uint32_t step = back[last].code(coder, Coder::reads ? 0 : n - 1 - tree->parent_of_node()[n]);
      if (step >= n)
        throw FormatError("tree section: node " + std::to_string(n) + " has its parent before the root");
      parents.push_back(n - 1 - step);
      last = std::min(static_cast<unsigned>(std::bit_width(step)), 3u);
    }
    return parents;
  }
  std::array<std::array<AdaptiveNumber, 4>, 4>
      counts;  // after the parent's number of children, and the last node's
  Parents parents(numbering, size);
  std::vector<std::uint8_t> kind(size);  // number of children, 3 for more
  unsigned last = 0;
  for (std::uint32_t n = 0; n < size; ++n) {
    if (!parents.waits())
      throw FormatError("tree section: no node is the parent of node " + std::to_string(n));
    const unsigned above = n == 0 ? 0 : kind[parents.next()];
    const std::uint32_t children = counts[above][last].code(
        coder, Coder::reads ? 0 : static_cast<std::uint32_t>(tree->children(n).size()));
    parents.add(children);
    kind[n] = static_cast<std::uint8_t>(last = std::min(children, 3u));
  }
  if (size > 0 && parents.waits())
    throw FormatError("tree section: some node has more children than there are nodes");
  return parents.parents();
}

// Objects of the nodes with these parents; a writer's are `objects`.
template <typename Coder>
std::vector<std::uint32_t> code_objects(Coder& coder, std::span<const std::uint32_t> parents,
                                        std::uint32_t object_count, std::span<const std::uint32_t> objects) {
  std::vector<bool> has_children(parents.size(), false);
  for (std::size_t n = 1; n < parents.size(); ++n) has_children[parents[n]] = true;
  constexpr std::uint32_t unseen = 0xffffffff;
  std::array<AdaptiveBit, 2> holds;
  std::array<AdaptiveBit, 2> is_new;
  AdaptiveNumber back;
  Steps steps(object_count);
  std::vector<std::uint32_t> result, held, last_place(objects.empty() ? 0 : object_count, unseen);
  bool last_new = true;
  for (std::size_t n = 0; n < parents.size(); ++n) {
    const std::uint32_t object = Coder::reads ? 0 : objects[n];
    if (!coder.bit(holds[has_children[n]], object != ObjectTree::none)) {
      result.push_back(ObjectTree::none);
      continue;
    }
    const bool before = !Coder::reads && last_place[object] != unseen;
    last_new = held.empty() ? true : steps.left() == 0 ? false : coder.bit(is_new[last_new], !before);
    if (last_new) {
      if (steps.left() == 0) throw FormatError("tree section: an object of none");
      held.push_back(steps.code(coder, object));
    } else {
      const auto count = static_cast<std::uint32_t>(held.size());
      const std::uint32_t steps_back = back.code(coder, Coder::reads ? 0 : count - 1 - last_place[object]);
      if (steps_back >= count) throw FormatError("tree section: an object before the first");
      held.push_back(held[count - 1 - steps_back]);
    }
    result.push_back(held.back());
    if constexpr (!Coder::reads) last_place[object] = static_cast<std::uint32_t>(held.size() - 1);
  }
  return result;
}

}  // namespace

std::vector<std::byte> tree_bytes(const ObjectTree& tree, bool nodes) {
  const Numbering numbering = numbering_of(tree);
  std::vector<std::byte> out = {
      static_cast<std::byte>(std::uint8_t(numbering) | (nodes ? columns_are_nodes : 0))};
  put_varint(out, tree.object_count());
  put_varint(out, tree.size());
  const std::size_t begin = out.size();
  AdaptiveWriter coder(out);
  code_parents(coder, numbering, tree.size(), &tree);
  code_objects(coder, tree.parent_of_node(), tree.object_count(), tree.object_of_node());
  coder.finish();
  try {
    check_backed(tree.object_count(), out.size() - begin, "objects of a tree");
  } catch (const FormatError& error) {
    throw std::invalid_argument(error.what());
  }
  return out;
}

std::pair<ObjectTree, bool> tree_from_bytes(std::span<const std::byte> bytes) {
  ByteReader in(bytes, "tree section");
  const auto flags = in.number<std::uint8_t>();
  const bool nodes = (flags & columns_are_nodes) != 0;
  const auto numbering = Numbering(flags & 3);
  if (flags > (columns_are_nodes | 2) || (flags & 3) > 2) in.fail("a numbering that there is not");
  const std::uint64_t objects = in.varint(), size = in.varint();
  if (objects > 0xffffffff || size >= ObjectTree::none) in.fail("more than 32 bits of objects or nodes");
  check_backed(objects, in.left(), "objects of a tree");
  check_backed(size, in.left(), "nodes of a tree");
  AdaptiveReader coder(bytes.subspan(in.offset()));
  auto parents = code_parents(coder, numbering, static_cast<std::uint32_t>(size), nullptr);
  auto held = code_objects(coder, parents, static_cast<std::uint32_t>(objects), {});
  try {
    auto tree =
        ObjectTree::from_parents(std::move(parents), std::move(held), static_cast<std::uint32_t>(objects));
    if (!std::ranges::equal(tree_bytes(tree, nodes), bytes)) in.fail("another code than the writer's");
    return {std::move(tree), nodes};
  } catch (const std::invalid_argument& error) {
    in.fail(error.what());
  }
}

}  // namespace vismat
