// ALGORITHM. The tree of nodes leads to leaves, whose clusters are the view cells and whose faces are the objects;
// quake3_lumps.cpp has the format. Every index is checked once, where it is read, against the lump to which it points.
// Real levels show more than the descriptions of the format say: leaf 0 and one leaf for each brush model (doors,
// platforms) are reached by no node and name cluster 0 with an empty box, so places are taken only from leaves that are
// reached; and faces share meshverts, so their sum says nothing about the lump and needs a limit of its own.
#include "visibility/levels/quake3_bsp.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <glm/vec3.hpp>
#include <string>
#include <utility>
#include <vector>

#include "visibility/levels/level_tree.h"
#include "visibility/levels/quake3_faces.h"
#include "visibility/levels/quake3_lumps.h"

namespace vismat {
namespace {

using namespace quake3;

constexpr std::size_t most_places = 1
                                    << 15;  // leaves with a cluster; the engine's 2 MB of visdata end at 4096

VisibilityMatrix read_visdata(std::span<const std::byte> lump) {
  const std::string name = name_of(visdata_lump);
  ByteReader reader(lump, name.c_str());
  const auto clusters = reader.number<std::int32_t>(), row_bytes = reader.number<std::int32_t>();
  if (clusters <= 0) refuse(visdata_lump, std::to_string(clusters) + " clusters; a level has at least one");
  if (const std::int64_t least = (std::int64_t{clusters} + 7) / 8; row_bytes < least) {
    refuse(visdata_lump, "rows of " + std::to_string(row_bytes) + " bytes; " + std::to_string(clusters) +
                             " clusters need at least " + std::to_string(least));
  }
  if (const std::int64_t need = std::int64_t{clusters} * row_bytes;
      need > static_cast<std::int64_t>(reader.left())) {
    refuse(visdata_lump, std::to_string(clusters) + " rows of " + std::to_string(row_bytes) + " bytes need " +
                             std::to_string(need) + ", but only " + std::to_string(reader.left()) +
                             " are there");
  }
  const auto size = static_cast<std::uint32_t>(clusters);
  BitRows bits({size, size});
  const std::size_t used_bytes = (std::size_t{size} + 7) / 8;
  for (std::uint32_t r = 0; r < size; ++r) {
    const auto row = bits.row(r);
    std::memcpy(row.data(), reader.bytes(static_cast<std::size_t>(row_bytes)).data(), used_bytes);
    if (size % 64 != 0) row.back() &= (std::uint64_t{1} << (size % 64)) - 1;
  }
  return checked_matrix(bits, name_of(visdata_lump));
}

// Without visibility data the leaves alone tell how many clusters there are.
std::uint32_t clusters_named_by(std::span<const Leaf> leafs) {
  std::int64_t clusters = 0;
  for (std::size_t i = 0; i < leafs.size(); ++i) {
    if (leafs[i].cluster >= static_cast<std::int64_t>(std::min(leafs.size(), most_places))) {
      refuse(leafs_lump, "leaf", i,
             "cluster " + std::to_string(leafs[i].cluster) + " of a level with " +
                 std::to_string(leafs.size()) + " leafs, each of which is in at most one");
    }
    clusters = std::max<std::int64_t>(clusters, std::int64_t{leafs[i].cluster} + 1);
  }
  return static_cast<std::uint32_t>(clusters);
}

void check_leafs(std::span<const Leaf> leafs, std::uint32_t clusters, std::size_t leaffaces) {
  std::int64_t sum = 0;
  std::size_t places = 0;
  for (std::size_t i = 0; i < leafs.size(); ++i) {
    const Leaf& leaf = leafs[i];
    places += leaf.cluster >= 0;
    if (leaf.cluster >= std::int64_t{clusters}) {
      refuse(leafs_lump, "leaf", i,
             "cluster " + std::to_string(leaf.cluster) + " of only " + std::to_string(clusters));
    }
    if (!in_range(leaf.first_face, leaf.faces, leaffaces)) {
      refuse(leafs_lump, "leaf", i,
             "leaffaces " + range(leaf.first_face, leaf.faces) + " of only " + std::to_string(leaffaces));
    }
    sum += leaf.faces;
  }
  if (places > most_places) {  // to find neighbours takes their square
    refuse(leafs_lump, std::to_string(places) + " leafs have a cluster; at most " +
                           std::to_string(most_places) + " are taken");
  }
  if (sum > static_cast<std::int64_t>(leaffaces)) {
    refuse(leafs_lump, "the leafs list " + std::to_string(sum) + " faces, but there are only " +
                           std::to_string(leaffaces) + " leaffaces: some overlap");
  }
}

glm::vec3 in_metres(const std::array<std::int32_t, 3>& corner) {
  return glm::vec3(corner[0], corner[1], corner[2]) * metres_per_level_unit;
}

std::vector<Box> cluster_boxes(std::span<const Leaf> places, std::uint32_t clusters) {
  std::vector<Box> boxes(clusters, empty_box);
  for (const Leaf& leaf : places) {
    grow(boxes[leaf.cluster], in_metres(leaf.low));
    grow(boxes[leaf.cluster], in_metres(leaf.high));
  }
  for (Box& box : boxes) box = zero_if_empty(box);
  return boxes;
}

bool touch(const Leaf& a, const Leaf& b) {
  int wide = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::int64_t overlap = std::int64_t{std::min(a.high[k], b.high[k])} - std::max(a.low[k], b.low[k]);
    if (overlap < -1) return false;
    wide += overlap > 1;
  }
  return wide >= 2;
}

VisibilityMatrix cluster_neighbours(std::vector<Leaf> places, std::uint32_t clusters) {
  std::sort(places.begin(), places.end(), [](const Leaf& a, const Leaf& b) { return a.low[0] < b.low[0]; });
  BitRows neighbours({clusters, clusters});
  for (std::size_t i = 0; i < places.size(); ++i) {
    for (std::size_t j = i + 1; j < places.size() && places[j].low[0] <= std::int64_t{places[i].high[0]} + 1;
         ++j) {
      const auto a = static_cast<std::uint32_t>(places[i].cluster),
                 b = static_cast<std::uint32_t>(places[j].cluster);
      if (a == b || !touch(places[i], places[j])) continue;
      neighbours.set(a, b);
      neighbours.set(b, a);
    }
  }
  return checked_matrix(neighbours, "neighbours of clusters");
}

// How far the compiler let anything be seen, by the first entity's keys, in metres; 0: without limit.
float far_plane_of(const Lumps& lumps) {
  std::string_view world(reinterpret_cast<const char*>(lumps[entities_lump].data()),
                         lumps[entities_lump].size());
  world = world.substr(0, world.find('}'));
  for (const std::string_view key : {"\"_farplanedist\"", "\"fogclip\"", "\"distancecull\""}) {
    const std::size_t at = world.find(key);
    if (at == std::string_view::npos) continue;
    const std::string_view rest = world.substr(at + key.size());
    const std::size_t quote = rest.find('"');
    if (quote == std::string_view::npos) continue;
    float units = 0;
    std::from_chars(rest.data() + quote + 1, rest.data() + rest.size(), units);
    return std::isfinite(units) ? std::max(0.0f, units * metres_per_level_unit) : 0;
  }
  return 0;
}

// Planes in metres; none at all where the lump is empty, which no compiler leaves so.
LevelPlaces places_of(const Lumps& lumps, std::span<const Node> nodes, std::span<const Leaf> leafs) {
  LevelPlaces places;
  places.planes = records_of<LevelPlaces::Plane>(lumps, planes_lump);
  if (places.planes.empty()) return {};
  for (LevelPlaces::Plane& plane : places.planes) plane.distance *= metres_per_level_unit;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (!in_range(nodes[i].plane, 1, places.planes.size())) {
      refuse(nodes_lump, "node", i,
             "plane " + std::to_string(nodes[i].plane) + " of only " + std::to_string(places.planes.size()));
    }
    const LevelPlaces::Plane& plane = places.planes[nodes[i].plane];
    if (!std::isfinite(plane.normal.x + plane.normal.y + plane.normal.z + plane.distance)) {
      refuse(planes_lump, "plane", static_cast<std::size_t>(nodes[i].plane), "is not finite");
    }
    places.nodes.push_back({static_cast<std::uint32_t>(nodes[i].plane), nodes[i].children});
  }
  for (const Leaf& leaf : leafs) places.cell_of_leaf.push_back(leaf.cluster);
  return places;
}

// One row for each leaf: its cluster.
VisibilityMatrix clusters_of_leafs(std::span<const Leaf> leafs, std::uint32_t clusters) {
  std::vector<std::vector<std::uint32_t>> rows(leafs.size());
  for (std::size_t i = 0; i < leafs.size(); ++i) {
    if (leafs[i].cluster >= 0) rows[i] = {static_cast<std::uint32_t>(leafs[i].cluster)};
  }
  return VisibilityMatrix::from_rows(rows, clusters);
}

}  // namespace

Level parse_quake3_bsp(std::span<const std::byte> file, const std::set<std::string>& see_through_shaders,
                       VisibilityData visibility) {
  const int version = version_of(file);
  const Lumps lumps = read_directory(file);
  Level level;
  level.format = "Quake 3 (IBSP " + std::to_string(version) + ")";
  level.cells_are = "cluster";
  const auto leafs = records_of<Leaf>(lumps, leafs_lump);
  level.has_visibility = !lumps[visdata_lump].empty();
  if (level.has_visibility) {
    level.cells = read_visdata(lumps[visdata_lump]);
  } else if (visibility == VisibilityData::needed) {
    refuse(visdata_lump,
           "empty: this level was compiled without visibility data; 'vismat scene' takes its triangles, and "
           "'vismat see' computes what is visible");
  } else {
    const std::uint32_t clusters = clusters_named_by(leafs);
    level.cells = VisibilityMatrix::from_rows(std::vector<std::vector<std::uint32_t>>(clusters), clusters);
  }
  const std::uint32_t clusters = level.cells.shape().rows;

  const auto leaffaces = records_of<std::int32_t>(lumps, leaffaces_lump);
  const auto faces = records_of<Face>(lumps, faces_lump);
  check_leafs(leafs, clusters, leaffaces.size());
  const auto node_records = records_of<Node>(lumps, nodes_lump);
  std::vector<BspChildren> nodes;
  for (const Node& node : node_records) nodes.push_back(node.children);
  const auto walk = walk_bsp(nodes, 0, static_cast<std::uint32_t>(leafs.size()), name_of(nodes_lump));
  level.places = places_of(lumps, node_records, leafs);
  level.far_plane = far_plane_of(lumps);

  // Cells: places from the leaves that the walk reached.
  std::vector<Leaf> places;
  std::vector<std::uint32_t> order;  // of those leaves
  for (const BspItem& item : walk) {
    if (item.child >= 0 || leafs[~item.child].cluster < 0) continue;
    const Leaf& leaf = leafs[~item.child];
    for (std::size_t k = 0; k < 3; ++k) {
      if (leaf.low[k] > leaf.high[k])
        refuse(leafs_lump, "leaf", static_cast<std::size_t>(~item.child), "its box is inside out");
    }
    order.push_back(static_cast<std::uint32_t>(~item.child));
    places.push_back(leaf);
  }
  level.cell_bounds = cluster_boxes(places, clusters);
  level.cell_neighbours = cluster_neighbours(std::move(places), clusters);
  level.cell_tree = level_tree(walk, clusters_of_leafs(leafs, clusters));

  // Faces: number the columns, then say which lie where.
  const auto faces_of = [&](const Leaf& leaf) {
    return std::span(leaffaces).subspan(static_cast<std::size_t>(leaf.first_face),
                                        static_cast<std::size_t>(leaf.faces));
  };
  constexpr std::uint32_t unused = 0xffffffff;
  std::vector<std::uint32_t> column_of_face(faces.size(), unused);
  for (const Leaf& leaf : leafs) {
    for (const std::int32_t face : faces_of(leaf)) {
      if (face < 0 || static_cast<std::size_t>(face) >= faces.size()) {
        refuse(leaffaces_lump, "leaf", static_cast<std::size_t>(&leaf - leafs.data()),
               "face " + std::to_string(face) + " of only " + std::to_string(faces.size()));
      }
      if (leaf.cluster >= 0 || !level.has_visibility) column_of_face[face] = 0;
    }
  }
  FaceGeometry geometry(lumps, see_through_shaders);
  for (std::uint32_t face = 0; face < faces.size(); ++face) {
    if (column_of_face[face] == unused) {
      ++level.faces_left_out;
      continue;
    }
    column_of_face[face] = static_cast<std::uint32_t>(level.face_ids.size());
    level.face_ids.push_back(face);
    level.face_bounds.push_back(geometry.add(faces[face], face));
  }
  level.face_scene = geometry.take();
  level.without_triangles = geometry.without_triangles();
  const auto columns = static_cast<std::uint32_t>(level.face_ids.size());

  std::vector<std::vector<std::uint32_t>> faces_of_cluster(clusters), faces_of_leaf(leafs.size());
  for (const Leaf& leaf : leafs) {
    if (leaf.cluster < 0) continue;
    for (const std::int32_t face : faces_of(leaf))
      faces_of_cluster[leaf.cluster].push_back(column_of_face[face]);
  }
  std::vector<bool> placed(columns, false);
  level.mover_faces = columns;
  for (const std::uint32_t leaf : order) {
    for (const std::int32_t face : faces_of(leafs[leaf])) {
      const std::uint32_t column = column_of_face[face];
      if (placed[column]) continue;
      placed[column] = true;
      --level.mover_faces;
      faces_of_leaf[leaf].push_back(column);
    }
  }
  for (auto* rows : {&faces_of_cluster, &faces_of_leaf}) {
    for (auto& row : *rows) {
      std::sort(row.begin(), row.end());
      row.erase(std::unique(row.begin(), row.end()), row.end());
    }
  }
  level.faces_of_cell = VisibilityMatrix::from_rows(faces_of_cluster, columns);
  level.face_tree = level_tree(walk, VisibilityMatrix::from_rows(faces_of_leaf, columns));
  return level;
}

}  // namespace vismat
