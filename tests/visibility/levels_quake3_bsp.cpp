#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "matrix/base/byte_reader.h"
#include "tests/visibility/levels_tiny.h"
#include "visibility/levels/quake3_bsp.h"

namespace vismat {
namespace {

using test::refusal;
using tiny::Quake;
using Ids = std::vector<std::uint32_t>;
constexpr std::uint32_t none = ObjectTree::none;

std::string refused(const Quake& quake) {
  return refusal([&] { parse_quake3_bsp(quake.bytes()); });
}

TEST(Quake3Bsp, ClustersSeeWhatTheirBitsSay) {
  const Level level = parse_quake3_bsp(Quake().bytes());
  EXPECT_EQ(level.cells, VisibilityMatrix::from_rows({{0, 1}, {0, 1, 2}, {1, 2}}, 3));
  EXPECT_EQ(level.cells_are, "cluster");
}

TEST(Quake3Bsp, Version47IsReadTheSame) {
  Quake quake;
  quake.version = 47;
  const Level level = parse_quake3_bsp(quake.bytes()), of_46 = parse_quake3_bsp(Quake().bytes());
  EXPECT_EQ(level.format, "Quake 3 (IBSP 47)");
  EXPECT_EQ(level.cells, of_46.cells);
  EXPECT_EQ(level.face_scene.vertices, of_46.face_scene.vertices);
}

TEST(Quake3Bsp, ASceneNeedsNoVisibilityData) {
  Quake quake;
  const Scene scene = parse_quake3_bsp(quake.bytes()).face_scene;
  quake.has_visdata = false;
  Level level = parse_quake3_bsp(quake.bytes(), {}, VisibilityData::not_needed);
  EXPECT_FALSE(level.has_visibility);
  EXPECT_EQ(level.cells.shape(), (Shape{3, 3}));
  EXPECT_EQ(level.cells.ones(), 0u);
  EXPECT_EQ(level.face_scene.vertices, scene.vertices);
  EXPECT_EQ(level.face_scene.indices, scene.indices);
  EXPECT_EQ(level.face_scene.object_of_triangle, scene.object_of_triangle);
  level.name = "x.bsp";
  EXPECT_EQ(refusal([&] { level_dataset(level, LevelMatrix::cells, LevelTree::none); }),
            "x.bsp: was compiled without visibility data; 'vismat see' computes it");

  for (auto& leaf : quake.leafs) leaf.cluster = -1;  // a compiler that stopped early numbers no clusters
  level = parse_quake3_bsp(quake.bytes(), {}, VisibilityData::not_needed);
  EXPECT_EQ(level.cells.shape(), (Shape{0, 0}));
  EXPECT_EQ(level.face_scene.indices, scene.indices);
  quake.leafs[2].cluster = 7;
  EXPECT_EQ(refusal([&] { parse_quake3_bsp(quake.bytes(), {}, VisibilityData::not_needed); }),
            "lump 4 (leafs): leaf 2: cluster 7 of a level with 7 leafs, each of which is in at most one");
}

TEST(Quake3Bsp, RowsOfManyWords) {
  Quake quake;
  quake.clusters = 130;
  quake.row_bytes = 17;
  quake.rows.assign(130 * 17, 0);
  quake.rows[129 * 17 + 16] = 0b110;  // cluster 129 sees itself; bit 130 is junk
  quake.rows[5 * 17 + 8] = 1;         // 5 sees 64
  const Level level = parse_quake3_bsp(quake.bytes());
  EXPECT_EQ(level.cells.ones(), 2u);
  EXPECT_TRUE(level.cells.contains(129, 129));
  EXPECT_TRUE(level.cells.contains(5, 64));
}

TEST(Quake3Bsp, BoxesAreInMetresAndLeaveOutLeafsNoNodeLeadsTo) {
  const Level level = parse_quake3_bsp(Quake().bytes());
  const std::vector<Box> boxes = {{{0, 0, 0}, {2, 2, 2}}, {{2, 0, 0}, {4, 4, 2}}, {{4, 0, 0}, {6, 2, 2}}};
  EXPECT_EQ(level.cell_bounds, boxes);
  Quake away;  // were leaf 0 taken for a place, cluster 0 would reach to the origin
  for (auto* leaf : {&away.leafs[1], &away.leafs[2]}) {
    leaf->box[0] += 640;
    leaf->box[3] += 640;
  }
  EXPECT_EQ(parse_quake3_bsp(away.bytes()).cell_bounds[0], (Box{{20, 0, 0}, {22, 2, 2}}));
}

TEST(Quake3Bsp, NeighboursShareMoreThanAnEdge) {
  EXPECT_EQ(parse_quake3_bsp(Quake().bytes()).cell_neighbours,
            VisibilityMatrix::from_rows({{1}, {0, 2}, {1}}, 3));
  Quake edge;  // cluster 2 moves over to where it meets cluster 0 along an edge, cluster 1 along an area
  edge.leafs[4].box = {64, 64, 0, 128, 128, 64};
  edge.leafs[5].box = {128, 0, 0, 192, 64, 64};
  EXPECT_EQ(parse_quake3_bsp(edge.bytes()).cell_neighbours,
            VisibilityMatrix::from_rows({{1}, {0, 2}, {1}}, 3));
  Quake gap;  // one unit of rounding is forgiven, two are not
  gap.leafs[4].box[0] = 129;
  EXPECT_TRUE(parse_quake3_bsp(gap.bytes()).cell_neighbours.contains(1, 2));
  gap.leafs[4].box[0] = 130;
  EXPECT_FALSE(parse_quake3_bsp(gap.bytes()).cell_neighbours.contains(1, 2));
}

TEST(Quake3Bsp, ClusterTreePrunesSolidLeafsAndSingleChildren) {
  const ObjectTree tree = parse_quake3_bsp(Quake().bytes()).cell_tree;
  EXPECT_EQ(tree, ObjectTree::from_parents({none, 0, 1, 1, 0, 4, 4}, {none, none, 0, 1, none, 1, 2}, 3));
}

TEST(Quake3Bsp, BranchOfOneClusterBecomesOneLeaf) {
  Quake quake;
  quake.leafs[4].cluster = 1;  // node 2 now holds nothing else; cluster 2 is in no leaf and hangs on the root
  const ObjectTree tree = parse_quake3_bsp(quake.bytes()).cell_tree;
  EXPECT_EQ(tree, ObjectTree::from_parents({none, 0, 0, 2, 3, 3, 2}, {none, 2, none, none, 0, 1, 1}, 3));
}

TEST(Quake3Bsp, FacesAreThoseOfClusteredLeafs) {
  const Level level = parse_quake3_bsp(Quake().bytes());
  EXPECT_EQ(level.face_ids, (Ids{0, 1, 2, 3, 5}));
  EXPECT_EQ(level.mover_faces, 1u);
  EXPECT_EQ(face_visibility(level),
            VisibilityMatrix::from_rows({{0, 1, 2, 4}, {0, 1, 2, 3, 4}, {1, 2, 3}}, 5));
}

TEST(Quake3Bsp, FaceTreeHasEachFaceOnceUnderItsFirstLeaf) {
  const ObjectTree tree = parse_quake3_bsp(Quake().bytes()).face_tree;
  EXPECT_EQ(tree, ObjectTree::from_parents({none, 0, 0, 2, 3, 4, 4, 3, 2},
                                           {none, 4, none, none, none, 0, 1, 2, 3}, 5));
}

TEST(Quake3Bsp, SceneHasOneObjectAFace) {
  const Level level = parse_quake3_bsp(Quake().bytes());
  const Scene& scene = level.face_scene;
  EXPECT_EQ(scene.object_count, 5u);
  Ids triangles(5, 0);
  for (const std::uint32_t object : scene.object_of_triangle) ++triangles[object];
  EXPECT_EQ(triangles, (Ids{2, 1, 32, 0, 1}));
  EXPECT_EQ(scene.indices.size(), 3 * scene.object_of_triangle.size());
  for (const std::uint32_t index : scene.indices) EXPECT_LT(index, scene.vertices.size());
  EXPECT_EQ(scene.vertices[scene.indices[6]],
            glm::vec3(2, 0, 0));  // the mesh counts from its own first vertex
  EXPECT_EQ(level.face_bounds[0], (Box{{0, 0, 0}, {2, 2, 0}}));
  EXPECT_EQ(level.face_bounds[2],
            (Box{{2, 0, 0}, {4, 2, 0.5f}}));  // a parabola reaches half its control point
  EXPECT_EQ(level.face_bounds[3], (Box{{5, 1, 1}, {5, 1, 1}}));
}

TEST(Quake3Bsp, SeeThroughAndUndrawnByTheShadersFlags) {
  EXPECT_TRUE(parse_quake3_bsp(Quake().bytes()).face_scene.see_through.empty()) << "all are opaque";
  Quake quake;
  quake.shaders = {{0x4, 1}, {0, 0x20000001}, {0x4000, 0}, {0x10080, 0}};  // sky, glass, leafage, never drawn
  for (std::int32_t i = 0; i < 4; ++i) quake.faces[i].shader = i;
  const Level level = parse_quake3_bsp(quake.bytes());
  EXPECT_EQ(level.face_scene.see_through, (std::vector<std::uint8_t>{0, 1, 1, 1, 0}));
  quake.faces[2].shader = 3;
  const Scene scene = parse_quake3_bsp(quake.bytes()).face_scene;
  EXPECT_EQ(std::count(scene.object_of_triangle.begin(), scene.object_of_triangle.end(), 2u), 0);
  EXPECT_EQ(scene.object_of_triangle.size(), 4u) << "the patch alone is gone";
  EXPECT_EQ(parse_quake3_bsp(quake.bytes()).face_bounds, level.face_bounds) << "it keeps its place";
  for (const std::uint32_t index : scene.indices) EXPECT_LT(index, scene.vertices.size());
  quake.faces[1].shader = 4;
  EXPECT_EQ(refused(quake), "lump 13 (faces): face 1: shader 4 of only 4");
  quake.shaders.clear();
  EXPECT_TRUE(parse_quake3_bsp(quake.bytes()).face_scene.see_through.empty()) << "nothing is known of them";
}

TEST(Quake3Bsp, CountsWhatTheSceneDoesNotHold) {
  using Lines = std::vector<std::string>;
  EXPECT_EQ(left_out_of_faces(parse_quake3_bsp(Quake().bytes())),
            (Lines{"1 billboards without triangles", "1 faces in no cluster left out"}));
  Quake quake;
  quake.shaders = {{0, 1}, {0x80, 0}};
  quake.faces[0].shader = 1;
  quake.faces[1].type = 5;
  quake.faces[5].type = 0;
  quake.faces[5].first_vertex = 1 << 20;  // means nothing in a kind that is not known
  quake.faces.push_back({1, 0, 4, 0, 0});
  quake.leaffaces[6] = 6;
  quake.leaffaces.push_back(5);
  quake.leafs[6].faces = 2;
  EXPECT_EQ(
      left_out_of_faces(parse_quake3_bsp(quake.bytes())),
      (Lines{"1 billboards without triangles", "1 faces without triangles since they are never drawn",
             "1 faces without triangles since they list none",
             "2 faces without triangles since their kind is not read", "1 faces in no cluster left out"}));
  EXPECT_EQ(parse_quake3_bsp(quake.bytes()).face_bounds[1], (Box{{0, 0, 0}, {2, 2, 0}}))
      << "foliage keeps the place of its vertexes";
}

TEST(Quake3Bsp, NamesOfShadersAreComparedAsTheEngineDoes) {
  Quake quake;
  quake.shader_name = "Textures\\Base/Glass.tga";
  EXPECT_EQ(parse_quake3_bsp(quake.bytes(), {"textures/base/glass"}).face_scene.see_through,
            std::vector<std::uint8_t>(5, 1));
  EXPECT_TRUE(parse_quake3_bsp(quake.bytes(), {"textures/base"}).face_scene.see_through.empty());
}

TEST(Quake3Bsp, PatchOfSeveralPiecesIsSeamless) {
  Quake quake;
  quake.vertexes.clear();
  for (const float y : {0.f, 32.f, 64.f}) {
    for (const float x : {0.f, 32.f, 64.f, 96.f, 128.f}) quake.vertexes.push_back({x, y, 0});
  }
  quake.faces = {{2, 0, 15, 0, 0, 5, 3}};
  quake.leaffaces.assign(7, 0);
  const Scene scene = parse_quake3_bsp(quake.bytes()).face_scene;
  ASSERT_EQ(scene.vertices.size(), 9u * 5u);
  for (std::uint32_t i = 0; i < 45;
       ++i) {  // evenly spaced control points make an even grid, across the seam too
    EXPECT_EQ(scene.vertices[i], glm::vec3(i % 9, i / 9, 0) * 0.5f);
  }
  EXPECT_EQ(scene.indices.size(), 8u * 4u * 6u);
}

TEST(Quake3Bsp, DatasetSaysWhatIsKnown) {
  Level level = parse_quake3_bsp(Quake().bytes());
  level.name = "tiny.bsp";
  const Dataset cells = level_dataset(level, LevelMatrix::cells, LevelTree::level);
  EXPECT_EQ(cells.rows_are, "cluster");
  EXPECT_EQ(cells.columns_are, "cluster");
  EXPECT_EQ(cells.guarantee, Guarantee::conservative);
  EXPECT_EQ(cells.provenance, "tiny.bsp, Quake 3 (IBSP 46)");
  EXPECT_EQ(cells.source.tree, level.cell_tree);
  const Dataset faces = level_dataset(level, LevelMatrix::faces, LevelTree::bounds);
  EXPECT_EQ(faces.columns_are, "face");
  EXPECT_EQ(faces.guarantee, Guarantee::unknown);  // a mover is filed under cluster 0, wherever it is
  EXPECT_EQ(faces.column_bounds, level.face_bounds);
  EXPECT_EQ(faces.source.tree->object_count(), 5u);
  EXPECT_FALSE(level_dataset(level, LevelMatrix::faces, LevelTree::none).source.tree.has_value());
  Quake still;
  still.leafs[6].faces = 0;
  EXPECT_EQ(level_dataset(parse_quake3_bsp(still.bytes()), LevelMatrix::faces, LevelTree::none).guarantee,
            Guarantee::conservative);
}

TEST(Quake3Bsp, EveryShorterPrefixIsRefused) {
  for (int last = 0; last < 17; ++last) {
    Quake quake;
    quake.last_lump = last;
    const auto bytes = quake.bytes();
    const Level whole = parse_quake3_bsp(bytes);
    for (std::size_t size = 0; size < bytes.size(); ++size) {
      try {  // only empty lumps can follow the last byte that counts
        const Level level = parse_quake3_bsp(std::span(bytes).first(size));
        EXPECT_EQ(level.cells, whole.cells) << "lump " << last << " cut to " << size;
        ADD_FAILURE() << "lump " << last << " cut to " << size << " of " << bytes.size() << " was taken";
      } catch (const FormatError& error) {
        EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
      }
    }
  }
}

TEST(Quake3Bsp, RefusesOtherFormats) {
  Quake quake;
  quake.magic = {'V', 'B', 'S', 'P'};
  EXPECT_EQ(refused(quake), "header: does not begin with IBSP, so it is no Quake level");
  quake = {};
  quake.version = 38;
  EXPECT_EQ(
      refused(quake),
      "header: IBSP version 38 (Quake 2); 46 (Quake 3) and 47 (Quake Live, Return to Castle Wolfenstein) are "
      "read");
  quake.version = 48;
  EXPECT_EQ(
      refused(quake),
      "header: IBSP version 48; 46 (Quake 3) and 47 (Quake Live, Return to Castle Wolfenstein) are read");
  quake.version = 46 << 24;
  EXPECT_EQ(
      refused(quake),
      "header: its numbers have the highest byte first, as on some consoles; only files with the lowest byte "
      "first are read");
  EXPECT_EQ(refusal([] { parse_quake3_bsp({}); }),
            "header: at byte 0: needs 4 more bytes, but only 0 are left");
}

TEST(Quake3Bsp, RefusesLumpsOutsideTheFile) {
  auto bytes = Quake().bytes();
  const auto set = [&](std::size_t at, std::int32_t value) { std::memcpy(bytes.data() + at, &value, 4); };
  const std::string end = " lie outside the file of " + std::to_string(bytes.size()) + " bytes";
  set(8 + 8 * 13 + 4, 0x7fffffff);
  EXPECT_EQ(refusal([&] { parse_quake3_bsp(bytes); }).substr(0, 39),
            "lump 13 (faces): 2147483647 bytes at of");
  set(8 + 8 * 13 + 4, -104);
  EXPECT_NE(refusal([&] { parse_quake3_bsp(bytes); }).find("lump 13 (faces): -104 bytes at offset "),
            std::string::npos);
  set(8 + 8 * 13 + 4, 104);
  set(8 + 8 * 13, 0x7ffffff0);
  EXPECT_EQ(refusal([&] { parse_quake3_bsp(bytes); }),
            "lump 13 (faces): 104 bytes at offset 2147483632" + end);
  set(8 + 8 * 13, -1);
  EXPECT_EQ(refusal([&] { parse_quake3_bsp(bytes); }), "lump 13 (faces): 104 bytes at offset -1" + end);
}

TEST(Quake3Bsp, RefusesRecordsCutOff) {
  auto bytes = Quake().bytes();
  const std::int32_t length = 47;
  std::memcpy(bytes.data() + 8 + 8 * 4 + 4, &length, 4);
  EXPECT_EQ(refusal([&] { parse_quake3_bsp(bytes); }),
            "lump 4 (leafs): 47 bytes are no whole number of 48-byte records");
}

TEST(Quake3Bsp, RefusesBadVisdata) {
  Quake quake;
  quake.has_visdata = false;
  EXPECT_EQ(
      refused(quake),
      "lump 16 (visdata): empty: this level was compiled without visibility data; 'vismat scene' takes its "
      "triangles, and 'vismat see' computes what is visible");
  quake = {};
  quake.clusters = 0;
  EXPECT_EQ(refused(quake), "lump 16 (visdata): 0 clusters; a level has at least one");
  quake.clusters = 65;
  EXPECT_EQ(refused(quake), "lump 16 (visdata): rows of 8 bytes; 65 clusters need at least 9");
  quake.clusters = std::numeric_limits<std::int32_t>::max();
  EXPECT_EQ(refused(quake),
            "lump 16 (visdata): rows of 8 bytes; 2147483647 clusters need at least 268435456");
  quake.row_bytes = std::numeric_limits<std::int32_t>::max();
  EXPECT_EQ(refused(quake),
            "lump 16 (visdata): 2147483647 rows of 2147483647 bytes need 4611686014132420609, but only 24 "
            "are there");
  quake = {};
  quake.row_bytes = -8;
  EXPECT_EQ(refused(quake), "lump 16 (visdata): rows of -8 bytes; 3 clusters need at least 1");
}

TEST(Quake3Bsp, RefusesBadLeafs) {
  Quake quake;
  quake.leafs[2].cluster = 3;
  EXPECT_EQ(refused(quake), "lump 4 (leafs): leaf 2: cluster 3 of only 3");
  quake = {};
  quake.leafs[5].first_face = 7;
  EXPECT_EQ(refused(quake), "lump 4 (leafs): leaf 5: leaffaces 7 to 7 of only 7");
  quake.leafs[5].first_face = 0x7fffffff;
  quake.leafs[5].faces = 0x7fffffff;
  EXPECT_EQ(refused(quake), "lump 4 (leafs): leaf 5: leaffaces 2147483647 to 4294967293 of only 7");
  quake = {};
  quake.leafs[5].faces = -1;
  EXPECT_EQ(refused(quake), "lump 4 (leafs): leaf 5: leaffaces 5 to 3 of only 7");
  quake = {};
  quake.leafs[3].faces = 3;
  EXPECT_EQ(refused(quake),
            "lump 4 (leafs): the leafs list 10 faces, but there are only 7 leaffaces: some overlap");
  quake = {};
  quake.leafs[4].box[0] = 193;
  EXPECT_EQ(refused(quake), "lump 4 (leafs): leaf 4: its box is inside out");
  quake = {};
  for (const int unused : {0, 3, 6}) quake.leafs[unused].box = {99999, 99999, 99999, -99999, -99999, -99999};
  EXPECT_EQ(refused(quake), "") << "leafs without a place, as some compilers mark them";
  quake = {};
  quake.leafs.resize(40000, {0, {0, 0, 0, 1, 1, 1}, 0, 0});
  EXPECT_EQ(refused(quake), "lump 4 (leafs): 39999 leafs have a cluster; at most 32768 are taken");
}

TEST(Quake3Bsp, CellsAlongASegment) {
  Quake quake;
  EXPECT_TRUE(parse_quake3_bsp(quake.bytes()).places.nodes.empty());
  // x: cluster 0 up to 64, 1 up to 128, 2 up to 192; farther out solid where z > 0.
  quake.planes = {{-1, 0, 0, -128}, {-1, 0, 0, -64}, {1, 0, 0, 192}, {0, 0, 1, 0}};
  const LevelPlaces places = parse_quake3_bsp(quake.bytes()).places;
  const auto along = [&](const glm::dvec3& from, const glm::dvec3& to) {
    std::vector<std::array<double, 3>> parts;
    for (const Stay& stay : stays_along(places, from, to))
      parts.push_back({double(stay.cell), stay.from, stay.to});
    return parts;
  };
  using Parts = std::vector<std::array<double, 3>>;
  EXPECT_EQ(along({0, 1, 1}, {8, 1, 1}),
            (Parts{{0, 0, 0.25}, {1, 0.25, 0.5}, {2, 0.5, 0.75}, {-1, 0.75, 1}}));
  EXPECT_EQ(along({8, 1, 1}, {0, 1, 1}),
            (Parts{{-1, 0, 0.25}, {2, 0.25, 0.5}, {1, 0.5, 0.75}, {0, 0.75, 1}}));
  EXPECT_EQ(along({0, 1, 1}, {1, 1, 1}), (Parts{{0, 0, 1}}));
  EXPECT_EQ(along({7, 1, 1}, {7, 1, -1}), (Parts{{-1, 0, 0.5}, {1, 0.5, 1}}));
  EXPECT_EQ(cell_at(places, {5, 0, 0}), 2);
  EXPECT_EQ(cell_at(places, {9, 0, 1}), -1);
  EXPECT_TRUE(has_point_in_cell(places, {{4, 0, 1}, {20, 1, 2}})) << "the first of six points along x";
  EXPECT_FALSE(has_point_in_cell(places, {{6, 0, 1}, {9, 1, 2}}));
  EXPECT_TRUE(has_point_in_cell(places, {{6, 0, -10}, {9, 1, 1}}));

  quake.planes.push_back({0, 0, std::numeric_limits<float>::quiet_NaN(), 0});  // of no node
  EXPECT_EQ(parse_quake3_bsp(quake.bytes()).places.nodes.size(), 4u);
  quake.planes.resize(3);
  EXPECT_EQ(refused(quake), "lump 3 (nodes): node 3: plane 3 of only 3");
  quake.planes.push_back({0, 0, std::numeric_limits<float>::infinity(), 0});
  EXPECT_EQ(refused(quake), "lump 2 (planes): plane 3: is not finite");
}

TEST(Quake3Bsp, FarPlane) {
  const auto far_plane = [](const std::string& entities) {
    Quake quake;
    quake.entities = entities;
    return parse_quake3_bsp(quake.bytes()).far_plane;
  };
  EXPECT_EQ(far_plane("{}"), 0);
  EXPECT_EQ(far_plane("{\n\"_farplanedist\" \"4096\"\n}"), 128);
  EXPECT_EQ(far_plane("{ \"fogclip\" \"64.5\" \"distancecull\" \"32\" }"), 64.5f / 32);
  EXPECT_EQ(far_plane("{ } { \"_farplanedist\" \"4096\" }"), 0);  // not the world's
  EXPECT_EQ(far_plane("{ \"_farplanedist\" \"-1\" }"), 0);
  EXPECT_EQ(far_plane("{ \"_farplanedist\" \"nan\" }"), 0);
  EXPECT_EQ(far_plane("{ \"_farplanedist\" "), 0);
  Quake quake;
  quake.entities = "{ \"_farplanedist\" \"4096\" }";
  const Dataset dataset = level_dataset(parse_quake3_bsp(quake.bytes()), LevelMatrix::cells, LevelTree::none);
  EXPECT_EQ(dataset.guarantee, Guarantee::unknown);
  EXPECT_NE(dataset.provenance.find("nothing shown beyond 128 m"), std::string::npos);
}

TEST(Quake3Bsp, RefusesBadTrees) {
  Quake quake;
  quake.nodes[3][1] = 0;
  EXPECT_EQ(refused(quake), "lump 3 (nodes): node 0 is reached twice; a tree has no cycles");
  quake.nodes[3][1] = -2;
  EXPECT_EQ(refused(quake), "lump 3 (nodes): leaf 1 is reached twice; a tree has no cycles");
  quake.nodes[3][1] = 4;
  EXPECT_EQ(refused(quake), "lump 3 (nodes): a child is node 4 of only 4");
  quake.nodes[3][1] = -8;
  EXPECT_EQ(refused(quake), "lump 3 (nodes): a child is leaf 7 of only 7");
  quake.nodes[3][1] = std::numeric_limits<std::int32_t>::min();
  EXPECT_EQ(refused(quake), "lump 3 (nodes): a child is leaf 2147483647 of only 7");
  quake.nodes.clear();
  EXPECT_EQ(refused(quake), "lump 3 (nodes): a child is node 0 of only 0");
}

TEST(Quake3Bsp, RefusesBadFaces) {
  Quake quake;
  quake.leaffaces[4] = 6;
  EXPECT_EQ(refused(quake), "lump 5 (leaffaces): leaf 4: face 6 of only 6");
  quake.leaffaces[4] = -1;
  EXPECT_EQ(refused(quake), "lump 5 (leaffaces): leaf 4: face -1 of only 6");
  quake = {};
  quake.faces[1].first_vertex = 11;
  EXPECT_EQ(refused(quake), "lump 13 (faces): face 1: vertexes 11 to 13 of only 13");
  quake = {};
  quake.faces[1].first_index = 7;
  EXPECT_EQ(refused(quake), "lump 13 (faces): face 1: meshverts 7 to 9 of only 9");
  quake = {};
  quake.faces[1].indices = 2;
  EXPECT_EQ(refused(quake), "lump 13 (faces): face 1: 2 meshverts are no whole number of triangles");
  quake = {};
  quake.meshverts[8] = 3;
  EXPECT_EQ(refused(quake), "lump 11 (meshverts): meshvert 8: vertex 3 of a face that has 3");
  quake.meshverts[8] = -1;
  EXPECT_EQ(refused(quake), "lump 11 (meshverts): meshvert 8: vertex -1 of a face that has 3");
}

TEST(Quake3Bsp, RefusesBadPatches) {
  const std::string end =
      " control points with 9 vertexes; both sides are odd, at least 3, and multiply to them";
  for (const auto& [width, height] : {std::pair{9, 1}, {1, 9}, {3, 4}, {-3, -3}, {5, 3}, {0, 0}}) {
    Quake quake;
    quake.faces[2].width = width;
    quake.faces[2].height = height;
    EXPECT_EQ(refused(quake), "lump 13 (faces): face 2: a patch of " + std::to_string(width) + " x " +
                                  std::to_string(height) + end);
  }
}

TEST(Quake3Bsp, RefusesPlacesThatAreNotFinite) {
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    Quake quake;
    quake.vertexes[7][2] = bad;
    EXPECT_EQ(refused(quake), "lump 10 (vertexes): vertex 7: its position is not finite");
    quake = {};
    quake.faces[3].origin[1] = bad;
    EXPECT_EQ(refused(quake), "lump 13 (faces): face 3: its origin is not finite");
  }
}

TEST(Quake3Bsp, PlacesThatNothingUsesNeedNotBeFinite) {
  const float bad = std::numeric_limits<float>::quiet_NaN();
  const Level plain = parse_quake3_bsp(Quake().bytes());
  Quake quake;
  quake.vertexes.push_back({bad, 0, 0});  // of no face
  quake.faces[4].first_vertex = 10;       // of a face in no leaf
  quake.faces[4].origin = {bad, bad, bad};
  quake.faces[0].origin = {bad, bad, bad};  // of a face that has none
  EXPECT_EQ(parse_quake3_bsp(quake.bytes()).face_scene.vertices, plain.face_scene.vertices);
  quake.faces[1] = {3, 1, 3, 6, 3};
  quake.faces[5].first_vertex =
      13;  // the mover's: its last vertex is the bad one, and its triangle takes the first
  quake.faces[5].vertices = 4;
  quake.vertexes.insert(quake.vertexes.end() - 1, {{0, 0, 0}, {64, 0, 0}, {64, 64, 0}});
  const Level level = parse_quake3_bsp(quake.bytes());
  EXPECT_EQ(level.face_bounds, plain.face_bounds);
  EXPECT_EQ(level.face_scene.vertices.size(), plain.face_scene.vertices.size());
  for (const glm::vec3& vertex : level.face_scene.vertices) EXPECT_TRUE(std::isfinite(vertex.x));
}

TEST(Quake3Bsp, LumpsThatAreNotReadMayLieOutsideTheFile) {
  auto bytes = Quake().bytes();
  for (const std::size_t lump : {6, 7, 8, 9, 12, 14, 15}) {
    for (const auto& [at, value] : {std::pair{8 + 8 * lump, 0x7ffffff0}, {12 + 8 * lump, 1000}}) {
      std::memcpy(bytes.data() + at, &value, 4);
    }
  }
  EXPECT_EQ(parse_quake3_bsp(bytes).cells.ones(), 7u);
}

TEST(Quake3Bsp, RefusesFacesThatShareTooManyTriangles) {
  Quake quake;  // 1000 faces over one list of 60000 meshverts: 2 MB of file ask for 240 MB of triangles
  quake.meshverts.assign(60000, 0);
  quake.faces.assign(1000, {1, 0, 4, 0, 60000});
  quake.leaffaces.clear();
  for (int i = 0; i < 1000; ++i) quake.leaffaces.push_back(i);
  for (auto& leaf : quake.leafs) leaf.first_face = leaf.faces = 0;
  quake.leafs[1].faces = 1000;
  EXPECT_EQ(refused(quake),
            "lump 13 (faces): face 838: the faces up to here make more than 16777216 vertices or triangles");
}

}  // namespace
}  // namespace vismat
