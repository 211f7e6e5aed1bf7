#include "matrix/object_tree.h"

#include <algorithm>
#include <cassert>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

namespace vismat {

ObjectTree ObjectTree::from_parents(std::vector<std::uint32_t> parent_of_node,
                                    std::vector<std::uint32_t> object_of_node, std::uint32_t object_count) {
  const auto refuse = [](std::size_t node, const std::string& what) {
    throw std::invalid_argument("tree node " + std::to_string(node) + ": " + what);
  };
  if (parent_of_node.size() != object_of_node.size()) {
    throw std::invalid_argument("tree: " + std::to_string(parent_of_node.size()) + " parents but " +
                                std::to_string(object_of_node.size()) + " objects; need one of each a node");
  }
  const std::size_t size = parent_of_node.size();
  if (size >= none) throw std::invalid_argument("tree: more than 2^32 - 2 nodes");
  for (std::size_t i = 0; i < size; ++i) {
    if (i == 0 ? parent_of_node[i] != none : parent_of_node[i] >= i) {
      refuse(i, i == 0 ? "the root has a parent"
                       : "its parent " + std::to_string(parent_of_node[i]) + " does not come before it");
    }
    if (object_of_node[i] != none && object_of_node[i] >= object_count) {
      refuse(i, "object " + std::to_string(object_of_node[i]) + " of only " + std::to_string(object_count));
    }
  }
  ObjectTree tree;
  tree.object_count_ = object_count;
  tree.first_child_.assign(size + 1, 0);
  for (std::size_t i = 1; i < size; ++i) ++tree.first_child_[parent_of_node[i] + 1];
  for (std::size_t i = 0; i < size; ++i) tree.first_child_[i + 1] += tree.first_child_[i];
  tree.children_.resize(size == 0 ? 0 : size - 1);
  std::vector<std::uint32_t> next(tree.first_child_.begin(), tree.first_child_.end() - 1);
  for (std::size_t i = 1; i < size; ++i)
    tree.children_[next[parent_of_node[i]]++] = static_cast<std::uint32_t>(i);
  tree.parent_of_node_ = std::move(parent_of_node);
  tree.object_of_node_ = std::move(object_of_node);
  return tree;
}

VisibilityMatrix nodes_from_objects(const VisibilityMatrix& objects, const ObjectTree& tree) {
  assert(tree.object_count() == objects.shape().columns);
  std::vector<std::vector<std::uint32_t>> nodes_of_object(tree.object_count());
  for (std::uint32_t node = 0; node < tree.size(); ++node) {
    if (tree.object_of_node()[node] != ObjectTree::none)
      nodes_of_object[tree.object_of_node()[node]].push_back(node);
  }
  const std::uint32_t rows = objects.shape().rows;
  std::vector<std::uint64_t> offsets = {0};
  offsets.reserve(std::size_t{rows} + 1);
  std::vector<std::uint32_t> ids, seen;
  std::vector<bool> visible(tree.size(), false);
  for (std::uint32_t r = 0; r < rows; ++r) {
    seen.clear();
    for (const std::uint32_t object : objects.row(r)) {
      for (std::uint32_t node : nodes_of_object[object]) {
        for (; node != ObjectTree::none && !visible[node]; node = tree.parent_of_node()[node]) {
          visible[node] = true;
          seen.push_back(node);
        }
      }
    }
    std::sort(seen.begin(), seen.end());
    for (const std::uint32_t node : seen) visible[node] = false;
    ids.insert(ids.end(), seen.begin(), seen.end());
    offsets.push_back(ids.size());
  }
  return VisibilityMatrix::from_csr({rows, tree.size()}, std::move(offsets), std::move(ids));
}

bool is_monotone(const VisibilityMatrix& nodes, const ObjectTree& tree) {
  assert(tree.size() == nodes.shape().columns);
  std::vector<bool> visible(tree.size(), false);
  for (std::uint32_t r = 0; r < nodes.shape().rows; ++r) {
    for (const std::uint32_t node : nodes.row(r)) {  // ascending, so parents come first
      if (node != 0 && !visible[tree.parent_of_node()[node]]) return false;
      visible[node] = true;
    }
    for (const std::uint32_t node : nodes.row(r)) visible[node] = false;
  }
  return true;
}

std::vector<Box> node_bounds(const ObjectTree& tree, std::span<const Box> of_objects) {
  assert(of_objects.size() == tree.object_count());
  std::vector<std::optional<Box>> bounds(tree.size());
  const auto add = [&](std::uint32_t node, const Box& part) {
    bounds[node] = bounds[node] ? box_around(*bounds[node], part) : part;
  };
  for (std::uint32_t node = tree.size(); node-- > 0;) {  // children before their parents
    const std::uint32_t object = tree.object_of_node()[node];
    if (object != ObjectTree::none) add(node, of_objects[object]);
    if (node > 0 && bounds[node]) add(tree.parent_of_node()[node], *bounds[node]);
  }
  std::vector<Box> result;
  result.reserve(bounds.size());
  for (const auto& box : bounds) result.push_back(box.value_or(Box{}));
  return result;
}

}  // namespace vismat
