// A preorder walk lists parents before children, so one pass backwards finds what each branch holds, and one
// pass forwards numbers what is left after pruning. Merging branches of a single object helps Doom most, whose
// sectors fall into many subsectors: 11231 nodes over MAP12 of freedoom2 become 10589.
#include "visibility/levels/level_tree.h"

#include <utility>

#include "matrix/base/byte_reader.h"

namespace vismat {

std::vector<BspItem> walk_bsp(std::span<const BspChildren> nodes, std::uint32_t root,
                              std::uint32_t leaf_count, const std::string& lump_name) {
  std::vector<bool> node_reached(nodes.size(), false), leaf_reached(leaf_count, false);
  std::vector<BspItem> walk, open = {{static_cast<std::int32_t>(root), ObjectTree::none}};
  while (!open.empty()) {
    const BspItem item = open.back();
    open.pop_back();
    const bool is_leaf = item.child < 0;
    const std::uint32_t number = static_cast<std::uint32_t>(is_leaf ? ~item.child : item.child);
    auto& reached = is_leaf ? leaf_reached : node_reached;
    const std::string kind = is_leaf ? "leaf " : "node ";
    if (number >= reached.size()) {
      throw FormatError(lump_name + ": a child is " + kind + std::to_string(number) + " of only " +
                        std::to_string(reached.size()));
    }
    if (reached[number]) {
      throw FormatError(lump_name + ": " + kind + std::to_string(number) +
                        " is reached twice; a tree has no cycles");
    }
    reached[number] = true;
    const auto place = static_cast<std::uint32_t>(walk.size());
    walk.push_back(item);
    if (is_leaf) continue;
    open.push_back({nodes[number][1], place});
    open.push_back({nodes[number][0], place});
  }
  return walk;
}

ObjectTree level_tree(std::span<const BspItem> walk, const VisibilityMatrix& objects_of_leaf) {
  const std::uint32_t objects = objects_of_leaf.shape().columns;
  const auto objects_under = [&](const BspItem& item) {
    return item.child < 0 ? objects_of_leaf.row(static_cast<std::uint32_t>(~item.child))
                          : std::span<const std::uint32_t>();
  };
  // What a branch holds: nothing, this one object, or several.
  constexpr std::uint32_t nothing = ObjectTree::none, several = nothing - 1;
  std::vector<std::uint32_t> content(walk.size(), nothing), branches(walk.size(), 0);
  std::vector<bool> missing(objects, true);
  const auto join = [&](std::size_t i, std::uint32_t what) {
    content[i] = content[i] == nothing || content[i] == what ? what : several;
    ++branches[i];
  };
  for (std::size_t i = walk.size(); i-- > 0;) {
    for (const std::uint32_t object : objects_under(walk[i])) {
      join(i, object);
      missing[object] = false;
    }
    if (content[i] != nothing && walk[i].parent != ObjectTree::none) join(walk[i].parent, content[i]);
  }

  std::vector<std::uint32_t> parent_of_node, object_of_node;
  const auto add = [&](std::uint32_t parent, std::uint32_t object) {
    parent_of_node.push_back(parent);
    object_of_node.push_back(object);
    return static_cast<std::uint32_t>(parent_of_node.size() - 1);
  };
  std::uint32_t top = ObjectTree::none;
  for (std::uint32_t object = 0; object < objects; ++object) {
    if (!missing[object]) continue;
    if (top == ObjectTree::none) top = add(ObjectTree::none, ObjectTree::none);
    add(top, object);
  }
  std::vector<std::uint32_t> node_of_item(walk.size(), top);
  for (std::size_t i = 0; i < walk.size(); ++i) {
    const bool root = walk[i].parent == ObjectTree::none;
    if (content[i] == nothing || (!root && content[walk[i].parent] != several)) continue;
    const std::uint32_t parent = root ? top : node_of_item[walk[i].parent];
    if (content[i] != several) {
      add(parent, content[i]);
      continue;
    }
    node_of_item[i] = branches[i] == 1 ? parent : add(parent, ObjectTree::none);
    for (const std::uint32_t object : objects_under(walk[i])) add(node_of_item[i], object);
  }
  return ObjectTree::from_parents(std::move(parent_of_node), std::move(object_of_node), objects);
}

}  // namespace vismat
