// A header of 17 (offset, length) pairs, then lumps of fixed-size records that refer to one another by index:
//
//   nodes (3) -> leafs (4) -> leaffaces (5) -> faces (13) -> vertexes (10) and, relative to a face's first,
//   meshverts (11) leaf.cluster -> a row and a column of visdata (16): i32 n, i32 row_bytes, n rows of bits,
//   the lowest bit first
//
//   faces -> shaders (1): what the compiler knew of the material
//
// Every index is checked where it is read, once, against the lump it points into. What real levels taught
// beyond the format's descriptions: leaf 0 and one leaf for each brush model (doors, platforms) are reached
// by no node and say cluster 0 with an empty box, so places are taken from reached leafs only; faces share
// meshverts, so their sum says nothing about the lump and needs a limit of its own.
#include "visibility/levels/quake3_bsp.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstring>
#include <glm/vec3.hpp>
#include <string>
#include <utility>
#include <vector>

#include "visibility/geometry/growing_box.h"
#include "visibility/levels/level_tree.h"
#include "visibility/levels/records.h"

namespace vismat {
namespace {

enum LumpNumber {
  entities_lump = 0,
  shaders_lump = 1,
  planes_lump = 2,
  nodes_lump = 3,
  leafs_lump = 4,
  leaffaces_lump = 5,
  vertexes_lump = 10,
  meshverts_lump = 11,
  faces_lump = 13,
  visdata_lump = 16,
  lump_count = 17
};
constexpr std::array<const char*, lump_count> lump_names = {
    "entities",    "shaders", "planes",    "nodes",      "leafs",    "leaffaces",
    "leafbrushes", "models",  "brushes",   "brushsides", "vertexes", "meshverts",
    "effects",     "faces",   "lightmaps", "lightvols",  "visdata"};

struct Shader {
  char name[64];
  std::uint32_t surface, contents;  // flags
};
struct Node {
  std::int32_t plane;
  BspChildren children;
  std::int32_t low[3], high[3];
};
struct Leaf {
  std::int32_t cluster, area;
  std::array<std::int32_t, 3> low, high;
  std::int32_t first_face, faces, first_brush, brushes;
};
struct Vertex {
  glm::vec3 position;
  float texture[2][2], normal[3];
  std::uint8_t colour[4];
};
enum FaceType { polygon = 1, patch = 2, mesh = 3, billboard = 4 };
struct Face {
  std::int32_t shader, effect, type, first_vertex, vertices, first_index, indices, lightmap[5];
  glm::vec3 origin;
  float lightmap_axes[2][3], normal[3];
  std::int32_t width, height;  // of a patch's control points
};
static_assert(sizeof(Shader) == 72 && sizeof(Node) == 36 && sizeof(Leaf) == 48 && sizeof(Vertex) == 44 &&
              sizeof(Face) == 104);

constexpr std::size_t most_places = 1
                                    << 15;  // leafs with a cluster; the engine's 2 MB of visdata end at 4096
constexpr std::size_t most_scene_entries = 1
                                           << 24;  // vertices or triangles; the largest known level has 54150
constexpr int patch_steps = 4;

// Of a shader: drawn not at all; perhaps not opaque (nonsolid, lightfilter, alphashadow; translucent).
constexpr std::uint32_t surface_nodraw = 0x80, surface_perhaps_clear = 0x4000 | 0x8000 | 0x10000,
                        contents_translucent = 0x20000000;

std::string name_of(int lump) {
  return "lump " + std::to_string(lump) + " (" + lump_names[lump] + ")";
}

[[noreturn]] void refuse(int lump, const std::string& what) {
  throw FormatError(name_of(lump) + ": " + what);
}
[[noreturn]] void refuse(int lump, const char* kind, std::size_t number, const std::string& what) {
  refuse(lump, kind + (" " + std::to_string(number)) + ": " + what);
}

std::string range(std::int64_t first, std::int64_t count) {
  return std::to_string(first) + " to " + std::to_string(first + count - 1);
}
bool in_range(std::int64_t first, std::int64_t count, std::size_t size) {
  return first >= 0 && count >= 0 && first + count <= static_cast<std::int64_t>(size);
}

using Lumps = std::array<std::span<const std::byte>, lump_count>;

Lumps read_directory(std::span<const std::byte> file) {
  ByteReader header(file, "header");
  const auto magic = header.number<std::array<char, 4>>();
  if (std::string_view(magic.data(), 4) != "IBSP")
    throw FormatError("header: does not begin with IBSP, so it is no Quake level");
  if (const auto version = header.number<std::int32_t>(); version != 46) {
    throw FormatError("header: IBSP version " + std::to_string(version) + "; only 46 (Quake 3) is read");
  }
  Lumps lumps;
  for (int i = 0; i < lump_count; ++i) {
    const auto offset = header.number<std::int32_t>(), length = header.number<std::int32_t>();
    if (!in_range(offset, length, file.size())) {
      refuse(i, std::to_string(length) + " bytes at offset " + std::to_string(offset) +
                    " lie outside the file of " + std::to_string(file.size()) + " bytes");
    }
    lumps[i] = file.subspan(static_cast<std::size_t>(offset), static_cast<std::size_t>(length));
  }
  return lumps;
}

template <typename Record>
std::vector<Record> records_of(const Lumps& lumps, int lump) {
  return read_records<Record>(lumps[lump], name_of(lump));
}

VisibilityMatrix read_visdata(std::span<const std::byte> lump) {
  if (lump.empty()) refuse(visdata_lump, "empty: this level was compiled without visibility data");
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
    for (std::size_t k = 0; k < 3; ++k) {
      if (leaf.low[k] > leaf.high[k]) refuse(leafs_lump, "leaf", i, "its box is inside out");
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
  std::vector<GrowingBox> grown(clusters);
  for (const Leaf& leaf : places) {
    grown[leaf.cluster].add(in_metres(leaf.low));
    grown[leaf.cluster].add(in_metres(leaf.high));
  }
  std::vector<Box> boxes;
  for (const GrowingBox& place : grown) boxes.push_back(place.box());
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

// One scene object a call to add(): grows the scene by a face's triangles and tells where they are.
class FaceGeometry {
 public:
  FaceGeometry(const Lumps& lumps, const std::set<std::string>& see_through_shaders)
      : shaders_(records_of<Shader>(lumps, shaders_lump)),
        vertices_(records_of<Vertex>(lumps, vertexes_lump)),
        meshverts_(records_of<std::int32_t>(lumps, meshverts_lump)) {
    for (Shader& shader : shaders_) {
      std::string name(shader.name, ::strnlen(shader.name, sizeof shader.name));
      for (char& c : name) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
      if (see_through_shaders.contains(name)) shader.contents |= contents_translucent;
    }
    for (std::size_t i = 0; i < vertices_.size(); ++i) {
      if (!finite(vertices_[i].position)) refuse(vertexes_lump, "vertex", i, "its position is not finite");
    }
  }

  Box add(const Face& face, std::size_t number) {
    const Shader shader = shader_of(face, number);
    const std::size_t first = scene_.vertices.size(), first_index = scene_.indices.size();
    GrowingBox places;
    if (face.type == polygon || face.type == mesh || face.type == patch) {
      const auto corners = corners_of(face, number);
      if (face.type == patch) {
        add_patch(face, number, corners);
      } else {
        add_triangles(face, number, corners);
      }
    } else if (face.type == billboard) {
      if (!finite(face.origin)) refuse(faces_lump, "face", number, "its origin is not finite");
      places.add(face.origin * metres_per_level_unit);
    }
    if (std::max(scene_.vertices.size(), scene_.indices.size() / 3) > most_scene_entries) {
      refuse(faces_lump, "face", number,
             "the faces up to here make more than " + std::to_string(most_scene_entries) +
                 " vertices or triangles");
    }
    for (std::size_t i = first; i < scene_.vertices.size(); ++i) places.add(scene_.vertices[i]);
    if ((shader.surface & surface_nodraw) != 0) {  // only bumped into
      scene_.vertices.resize(first);
      scene_.indices.resize(first_index);
    }
    scene_.see_through.push_back((shader.surface & surface_perhaps_clear) != 0 ||
                                 (shader.contents & contents_translucent) != 0);
    scene_.object_of_triangle.resize(scene_.indices.size() / 3, scene_.object_count++);
    return places.box();
  }

  Scene take() {
    const auto& clear = scene_.see_through;
    if (std::find(clear.begin(), clear.end(), 1) == clear.end()) scene_.see_through.clear();
    return std::move(scene_);
  }

 private:
  Shader shader_of(const Face& face, std::size_t number) const {
    if (shaders_.empty()) return {};
    if (!in_range(face.shader, 1, shaders_.size())) {
      refuse(faces_lump, "face", number,
             "shader " + std::to_string(face.shader) + " of only " + std::to_string(shaders_.size()));
    }
    return shaders_[face.shader];
  }

  static bool finite(const glm::vec3& p) {
    return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
  }

  std::vector<glm::vec3> corners_of(const Face& face, std::size_t number) const {
    if (!in_range(face.first_vertex, face.vertices, vertices_.size())) {
      refuse(faces_lump, "face", number,
             "vertexes " + range(face.first_vertex, face.vertices) + " of only " +
                 std::to_string(vertices_.size()));
    }
    std::vector<glm::vec3> corners;
    for (std::int32_t i = 0; i < face.vertices; ++i) {
      corners.push_back(vertices_[face.first_vertex + i].position * metres_per_level_unit);
    }
    return corners;
  }

  void add_triangles(const Face& face, std::size_t number, std::span<const glm::vec3> corners) {
    if (!in_range(face.first_index, face.indices, meshverts_.size())) {
      refuse(faces_lump, "face", number,
             "meshverts " + range(face.first_index, face.indices) + " of only " +
                 std::to_string(meshverts_.size()));
    }
    if (face.indices % 3 != 0) {
      refuse(faces_lump, "face", number,
             std::to_string(face.indices) + " meshverts are no whole number of triangles");
    }
    const auto base = static_cast<std::uint32_t>(scene_.vertices.size());
    scene_.vertices.insert(scene_.vertices.end(), corners.begin(), corners.end());
    for (std::int32_t i = 0; i < face.indices; ++i) {
      const std::int32_t index = meshverts_[face.first_index + i];
      if (index < 0 || index >= face.vertices) {
        refuse(meshverts_lump, "meshvert", static_cast<std::size_t>(face.first_index + i),
               "vertex " + std::to_string(index) + " of a face that has " + std::to_string(face.vertices));
      }
      scene_.indices.push_back(base + static_cast<std::uint32_t>(index));
    }
  }

  // Biquadratic Bezier pieces of 3 x 3 control points that share their borders.
  void add_patch(const Face& face, std::size_t number, std::span<const glm::vec3> control) {
    const std::int64_t width = face.width, height = face.height;
    if (width < 3 || height < 3 || width % 2 == 0 || height % 2 == 0 || width * height != face.vertices) {
      refuse(faces_lump, "face", number,
             "a patch of " + std::to_string(width) + " x " + std::to_string(height) +
                 " control points with " + std::to_string(face.vertices) +
                 " vertexes; both sides are odd, at least 3, and multiply to them");
    }
    const auto base = static_cast<std::uint32_t>(scene_.vertices.size());
    const auto columns = static_cast<std::uint32_t>((width - 1) / 2 * patch_steps + 1);
    const auto rows = static_cast<std::uint32_t>((height - 1) / 2 * patch_steps + 1);
    for (std::uint32_t row = 0; row < rows; ++row) {
      const Blend down(row, rows);
      for (std::uint32_t column = 0; column < columns; ++column) {
        const Blend along(column, columns);
        glm::vec3 point(0);
        for (std::size_t j = 0; j < 3; ++j) {
          for (std::size_t i = 0; i < 3; ++i) {
            const std::size_t at = (down.first + j) * static_cast<std::size_t>(width) + along.first + i;
            point += control[at] * (along.weights[i] * down.weights[j]);
          }
        }
        scene_.vertices.push_back(point);
      }
    }
    for (std::uint32_t row = 0; row + 1 < rows; ++row) {
      for (std::uint32_t column = 0; column + 1 < columns; ++column) {
        const std::uint32_t a = base + row * columns + column, b = a + columns;
        scene_.indices.insert(scene_.indices.end(), {a, b, a + 1, a + 1, b, b + 1});
      }
    }
  }

  struct Blend {  // where step `step` of a side lies: on which three control points, with which weights
    Blend(std::uint32_t step, std::uint32_t steps) {
      const std::uint32_t piece = std::min(step / patch_steps, (steps - 1) / patch_steps - 1);
      const float t = static_cast<float>(step - piece * patch_steps) / patch_steps;
      first = std::size_t{piece} * 2;
      weights = {(1 - t) * (1 - t), 2 * t * (1 - t), t * t};
    }
    std::size_t first;
    std::array<float, 3> weights;
  };

  std::vector<Shader> shaders_;
  std::vector<Vertex> vertices_;
  std::vector<std::int32_t> meshverts_;
  Scene scene_;
};

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
  for (std::size_t i = 0; i < places.planes.size(); ++i) {
    LevelPlaces::Plane& plane = places.planes[i];
    plane.distance *= metres_per_level_unit;
    if (!std::isfinite(plane.normal.x + plane.normal.y + plane.normal.z + plane.distance)) {
      refuse(planes_lump, "plane", i, "is not finite");
    }
  }
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (!in_range(nodes[i].plane, 1, places.planes.size())) {
      refuse(nodes_lump, "node", i,
             "plane " + std::to_string(nodes[i].plane) + " of only " + std::to_string(places.planes.size()));
    }
    places.nodes.push_back({static_cast<std::uint32_t>(nodes[i].plane), nodes[i].children});
  }
  for (const Leaf& leaf : leafs) places.cell_of_leaf.push_back(leaf.cluster);
  return places;
}

// Rows of leafs: the cluster of each.
VisibilityMatrix clusters_of_leafs(std::span<const Leaf> leafs, std::uint32_t clusters) {
  std::vector<std::vector<std::uint32_t>> rows(leafs.size());
  for (std::size_t i = 0; i < leafs.size(); ++i) {
    if (leafs[i].cluster >= 0) rows[i] = {static_cast<std::uint32_t>(leafs[i].cluster)};
  }
  return VisibilityMatrix::from_rows(rows, clusters);
}

}  // namespace

Level parse_quake3_bsp(std::span<const std::byte> file, const std::set<std::string>& see_through_shaders) {
  const Lumps lumps = read_directory(file);
  Level level;
  level.format = "Quake 3 (IBSP 46)";
  level.cells_are = "cluster";
  level.cells = read_visdata(lumps[visdata_lump]);
  const std::uint32_t clusters = level.cells.shape().rows;

  const auto leafs = records_of<Leaf>(lumps, leafs_lump);
  const auto leaffaces = records_of<std::int32_t>(lumps, leaffaces_lump);
  const auto faces = records_of<Face>(lumps, faces_lump);
  check_leafs(leafs, clusters, leaffaces.size());
  const auto node_records = records_of<Node>(lumps, nodes_lump);
  std::vector<BspChildren> nodes;
  for (const Node& node : node_records) nodes.push_back(node.children);
  const auto walk = walk_bsp(nodes, 0, static_cast<std::uint32_t>(leafs.size()), name_of(nodes_lump));
  level.places = places_of(lumps, node_records, leafs);
  level.far_plane = far_plane_of(lumps);

  // Cells: places from the leafs that the walk reached.
  std::vector<Leaf> places;
  std::vector<std::uint32_t> order;  // of those leafs
  for (const BspItem& item : walk) {
    if (item.child >= 0 || leafs[~item.child].cluster < 0) continue;
    order.push_back(static_cast<std::uint32_t>(~item.child));
    places.push_back(leafs[order.back()]);
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
      if (leaf.cluster >= 0) column_of_face[face] = 0;
    }
  }
  FaceGeometry geometry(lumps, see_through_shaders);
  for (std::uint32_t face = 0; face < faces.size(); ++face) {
    if (column_of_face[face] == unused) continue;
    column_of_face[face] = static_cast<std::uint32_t>(level.face_ids.size());
    level.face_ids.push_back(face);
    level.face_bounds.push_back(geometry.add(faces[face], face));
  }
  level.face_scene = geometry.take();
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
