#include "visibility/meshes/mesh_file.h"

#include <gtest/gtest.h>
#include <OpenMesh/Core/IO/MeshIO.hh>
#include <OpenMesh/Core/Mesh/PolyMesh_ArrayKernelT.hh>

#include <algorithm>
#include <array>
#include <cstring>
#include <glm/geometric.hpp>
#include <limits>
#include <set>
#include <string>
#include <string_view>

#include "matrix/base/atomic_file.h"
#include "matrix/base/byte_reader.h"
#include "tests/matrix/temporary_folder.h"
#include "tests/visibility/levels_tiny.h"
#include "visibility/generators/city.h"
#include "visibility/meshes/any_scene.h"
#include "visibility/meshes/components.h"

namespace vismat {
namespace {

using namespace std::literals;

Scene parse(std::string_view text, MeshFormat format) {
  return parse_mesh(std::as_bytes(std::span(text)), format).scene;
}

std::string refusal(std::string_view text, MeshFormat format) {
  try {
    parse(text, format);
  } catch (const FormatError& error) {
    return error.what();
  }
  return "was accepted";
}

/// Triangles by the places of their corners, the least corner first.
using Corners = std::array<std::array<float, 3>, 3>;
std::vector<Corners> triangles_of(const Scene& scene) {
  std::vector<Corners> triangles(scene.indices.size() / 3);
  for (std::size_t i = 0; i < scene.indices.size(); ++i) {
    const glm::vec3& p = scene.vertices[scene.indices[i]];
    triangles[i / 3][i % 3] = {p.x, p.y, p.z};
  }
  for (Corners& t : triangles) std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
  return triangles;
}

double area(const Scene& scene) {
  double sum = 0;
  for (std::size_t i = 0; i < scene.indices.size(); i += 3) {
    const glm::vec3 &a = scene.vertices[scene.indices[i]], &b = scene.vertices[scene.indices[i + 1]],
                    &c = scene.vertices[scene.indices[i + 2]];
    sum += glm::length(glm::cross(b - a, c - a)) / 2;
  }
  return sum;
}

template <typename... Numbers>
std::string bytes_of(Numbers... numbers) {
  std::string bytes;
  (bytes.append(reinterpret_cast<const char*>(&numbers), sizeof numbers), ...);
  return bytes;
}

TEST(MeshFile, FormatsAreToldByTheEndingInAnyCase) {
  EXPECT_EQ(mesh_format("a/b.OBJ"), MeshFormat::obj);
  EXPECT_EQ(mesh_format("b.ply"), MeshFormat::ply);
  EXPECT_EQ(mesh_format("b.x.Off"), MeshFormat::off);
  EXPECT_EQ(mesh_format("b.stl"), MeshFormat::stl);
  EXPECT_FALSE(mesh_format("b.scene.h5"));
  EXPECT_THROW(read_mesh("b.gltf"), std::invalid_argument);
  EXPECT_ANY_THROW(read_mesh("/no/such/file.obj"));
}

TEST(MeshFile, ObjWithEveryKindOfCorner) {
  const Scene scene = parse(
      "# a square and a triangle\r\n"
      "mtllib x.mtl\no thing\n\tv 0 0 0 1.0\nv +1 0 0\nv 1 1e0 0\nv 0 1 -0.0\nvt 0 0\nvn 0 0 1\n"
      "usemtl glass\ng side\ns off\nf 1/1/1 2/1 \\\n  3//1 4 # a comment\nf -1 -2 5\nl 1 2\nv .5 .5 1\n",
      MeshFormat::obj);
  EXPECT_EQ(scene.vertices.size(), 5u);
  EXPECT_EQ(scene.vertices[4], glm::vec3(.5f, .5f, 1));
  EXPECT_EQ(scene.object_count, 1u);
  EXPECT_EQ(scene.object_of_triangle, std::vector<std::uint32_t>(3, 0));
  ASSERT_EQ(scene.indices.size(), 9u);
  EXPECT_EQ(std::vector<std::uint32_t>(scene.indices.begin() + 6, scene.indices.end()),
            (std::vector<std::uint32_t>{3, 2, 4}));
}

TEST(MeshFile, PolygonsAreCutWhereTheyAreConcaveToo) {
  // An arrow head whose fan would cover its notch; a comb; a vertex on an edge.
  const auto cut = [](std::string_view points, std::size_t corners) {
    std::string text(points);
    text += "f";
    for (std::size_t i = 1; i <= corners; ++i) text += " " + std::to_string(i);
    const Scene scene = parse(text, MeshFormat::obj);
    EXPECT_EQ(scene.indices.size(), 3 * (corners - 2));
    return area(scene);
  };
  EXPECT_DOUBLE_EQ(cut("v 0 0 0\nv 2 1 0\nv 0 2 0\nv 1 1 0\n", 4), 1);
  EXPECT_DOUBLE_EQ(cut("v 5 1 1\nv 5 0 0\nv 5 2 1\nv 5 0 2\n", 4), 1);
  EXPECT_DOUBLE_EQ(cut("v 0 0 0\nv 0 0 5\nv 1 0 5\nv 1 0 1\nv 2 0 1\nv 2 0 5\nv 3 0 5\nv 3 0 0\n", 8), 11);
  EXPECT_DOUBLE_EQ(cut("v 0 0 0\nv 1 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\n", 5), 4);
  EXPECT_NEAR(cut("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\n", 4), .5, .5) << "one that crosses itself ends, too";
}

TEST(MeshFile, OffWithColoursAndComments) {
  const Scene scene = parse(
      "COFF # with colours\n4 2 0\n0 0 0 255 0 0 255\n1 0 0 9 9 9 9\n# none\n1 1 0 1 1 1 1\n"
      "0 1 2 0 0 0 0\n3 0 1 2 0.5 0.5 0.5\n3 0 2 3\n",
      MeshFormat::off);
  EXPECT_EQ(scene.vertices[3], glm::vec3(0, 1, 2));
  EXPECT_EQ(scene.indices, (std::vector<std::uint32_t>{0, 1, 2, 0, 2, 3}));
}

TEST(MeshFile, StlTextAndBinary) {
  const Scene text = parse(
      "solid two words\n facet normal 0 0 1\n  outer loop\n vertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
      "  endloop\n endfacet\nENDSOLID two words\n",
      MeshFormat::stl);
  std::string binary = "solid although it is binary";
  binary.resize(80);
  binary +=
      bytes_of(1u) + bytes_of(0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f, std::uint16_t{7});
  EXPECT_EQ(triangles_of(parse(binary, MeshFormat::stl)), triangles_of(text));
  EXPECT_EQ(text.indices.size(), 3u);
}

TEST(MeshFile, PlyOfAnyTypesAndOrder) {
  const Scene text = parse(
      "ply\nformat ascii 1.0\ncomment by hand\nelement camera 1\nproperty float f\nproperty list uchar int "
      "l\n"
      "element face 1\nproperty list uchar float texcoord\nproperty list uchar int vertex_index\n"
      "element vertex 3\nproperty uchar red\nproperty double z\nproperty double y\nproperty int x\n"
      "end_header\n1.5 2 8 9\n2 0.5 0.5 3 0 1 2\n255 0 0 0\n0 0 0 7\n0 0 1 0\n",
      MeshFormat::ply);
  EXPECT_EQ(text.vertices, (std::vector<glm::vec3>{{0, 0, 0}, {7, 0, 0}, {0, 1, 0}}));
  EXPECT_EQ(text.indices, (std::vector<std::uint32_t>{0, 1, 2}));
  const std::string big =
      "ply\nformat binary_big_endian 1.0\nelement vertex 3\nproperty short x\nproperty short y\n"
      "property char z\nelement face 1\nproperty list uint ushort vertex_indices\nend_header\n"
      "\0\0\0\0\0"
      "\0\7\0\0\0"
      "\0\0\0\1\0"
      "\0\0\0\3\0\0\0\1\0\2"s;
  EXPECT_EQ(triangles_of(parse(big, MeshFormat::ply)), triangles_of(text));
}

TEST(MeshFile, ReadsWhatOpenMeshWrites) {
  CityOptions options;
  options.size = 4;
  const Scene city = make_city(options).scene;
  OpenMesh::PolyMesh_ArrayKernelT<> mesh;
  std::vector<OpenMesh::VertexHandle> handles;
  for (const glm::vec3& p : city.vertices) handles.push_back(mesh.add_vertex({p.x, p.y, p.z}));
  for (std::size_t i = 0; i < city.indices.size(); i += 3) {
    ASSERT_TRUE(
        mesh.add_face(handles[city.indices[i]], handles[city.indices[i + 1]], handles[city.indices[i + 2]])
            .is_valid());
  }
  const TemporaryFolder folder;
  using Options = OpenMesh::IO::Options;
  for (const auto& [name, how] : {std::pair{"a.obj", Options::Default},
                                  {"a.off", Options::Default},
                                  {"text.ply", Options::Default},
                                  {"little.ply", Options::Binary},
                                  {"text.stl", Options::Default},
                                  {"binary.stl", Options::Binary}}) {
    ASSERT_TRUE(OpenMesh::IO::write_mesh(mesh, folder / name, how, 9));
    Scene read = read_mesh(folder / name).scene;
    EXPECT_EQ(triangles_of(read), triangles_of(city)) << name;
    const WeldCounts counts = weld(read);
    EXPECT_EQ(read.vertices.size(), city.vertices.size()) << name;
    EXPECT_EQ(counts.zero_area + counts.duplicates + counts.non_manifold_edges, 0u) << name;
    split_into_components(read);
    EXPECT_EQ(read.object_count, city.object_count) << name;
    EXPECT_EQ(read.object_of_triangle, city.object_of_triangle) << name;
  }
}

struct Bad {
  const char* name;
  MeshFormat format;
  std::string text;
  const char* message;
};
class BadMesh : public testing::TestWithParam<Bad> {};

TEST_P(BadMesh, IsRefusedInOneLineThatSaysWhere) {
  const TemporaryFolder folder;
  constexpr std::array endings = {".obj", ".ply", ".off", ".stl"};
  const std::string path = folder / ("bad"s + endings[static_cast<int>(GetParam().format)]);
  write_file(path, std::as_bytes(std::span(GetParam().text)));
  try {
    read_mesh(path);
    FAIL() << "was accepted";
  } catch (const FormatError& error) {
    EXPECT_EQ(error.what(), path + ": " + GetParam().message);
  }
}

const std::string triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
const std::string ply =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
    "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
const std::string binary_ply =
    "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
    "property float z\nelement face 1\nproperty list int int vertex_indices\nend_header\n";
const std::string facet =
    "solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n";
constexpr auto obj = MeshFormat::obj;
constexpr auto off = MeshFormat::off;
constexpr auto stl = MeshFormat::stl;

INSTANTIATE_TEST_SUITE_P(
    Each, BadMesh,
    testing::Values(
        Bad{"Empty", obj, "", "is empty"}, Bad{"Blank", obj, "\n\n", "holds no points"},
        Bad{"NoFaces", obj, triangle, "holds 3 points but no faces"},
        Bad{"NanPoint", obj, "v 0 nan 0\nf 1 1 1\n",
            "line 2: uses the point of line 1, where 'nan' is not a number within 1e9 of the origin"},
        Bad{"EndlessPoint", obj, "v 0 0 -inf\nf 1 1 1\n",
            "line 2: uses the point of line 1, where '-inf' is not a number within 1e9 of the origin"},
        Bad{"FarPoint", obj, "v 0 0 1e400\nf 1 1 1\n",
            "line 2: uses the point of line 1, where '1e400' is not a number within 1e9 of the origin"},
        Bad{"PointOfTwo", obj, "v 0 0\n", "line 1: ends where a coordinate is due"},
        Bad{"PointOfWords", obj, "\nv 0 zero 0\n", "line 2: 'zero' stands where a coordinate is due"},
        Bad{"NoSuchPoint", obj, triangle + "f 1 2 4\n",
            "line 4: names a point that is not among the 3 of the file"},
        Bad{"PointZero", obj, triangle + "f 0 1 2\n",
            "line 4: names point 0; points count from 1, or back from -1"},
        Bad{"FarBack", obj, triangle + "f 1 2 -4\n", "line 4: names point -4, but only 3 stand before it"},
        Bad{"AbsurdIndex", obj, triangle + "f 1 2 99999999999999999999\n",
            "line 4: '99999999999999999999' stands where a corner, such as 7 or 7/1/2, is due"},
        Bad{"WordIndex", obj, triangle + "f 1 2 x/1\n",
            "line 4: 'x/1' stands where a corner, such as 7 or 7/1/2, is due"},
        Bad{"NoCorners", obj, triangle + "f\n", "line 4: a face without corners"},
        Bad{"FreeForm", obj, triangle + "surf 0 1 0 1 1 2 3\n",
            "line 4: holds free-form curves or surfaces; export polygons"},
        Bad{"Unprintable", obj, "v 0 \x1b[2J 0\n", "line 1: '?[2J' stands where a coordinate is due"},
        Bad{"OffMagic", off, "OOF\n3 1 0\n",
            "line 1: begins with 'OOF'; need OFF (or COFF, NOFF, STOFF, NCOFF and so on) with points of "
            "three coordinates"},
        Bad{"OffBinary", off, "OFF BINARY\n", "line 1: is a binary OFF file; only text is read"},
        Bad{"OffThinAir", off, "OFF\n4000000000 1 0\n0 0 0\n",
            "line 4: the file ends after 1 of 4000000000 points"},
        Bad{"OffTooMany", off, "OFF\n5000000000 1 0\n",
            "line 2: '5000000000' stands where the number of points below 4294967295 is due"},
        Bad{"OffCut", off, "OFF\n3 2 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
            "line 7: the file ends after 1 of 2 faces"},
        Bad{"OffCutFace", off, "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1\n",
            "line 6: ends where a point's number is due"},
        Bad{"OffNegative", off, "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n",
            "line 6: '-1' stands where a point's number below 4294967295 is due"},
        Bad{"OffMore", off, "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n3 0 1 2\n",
            "line 7: '3' stands after the last of 1 faces"},
        Bad{"StlShort", stl, "x",
            "has 1 bytes; an STL file begins with the word solid or with 80 bytes and a number of triangles"},
        Bad{"StlLies", stl, std::string(80, 'x') + bytes_of(1000000u) + std::string(50, '\0'),
            "says that it has 1000000 triangles, which take 50000084 bytes; it has 134"},
        Bad{"StlNone", stl, std::string(80, 'x') + bytes_of(0u), "holds no triangles"},
        Bad{"StlNan", stl,
            std::string(80, 'x') +
                bytes_of(1u, 0.f, 0.f, 0.f, 0.f, 0.f, std::numeric_limits<float>::quiet_NaN()) +
                std::string(26, '\0'),
            "triangle 0: a coordinate is not a number within 1e9 of the origin"},
        Bad{"StlCut", stl, facet, "line 9: the file ends where endsolid is due"},
        Bad{"StlQuad", stl,
            "solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nvertex 0 0 "
            "0\n",
            "line 7: 'vertex' stands where endloop is due"},
        Bad{"PlyMagic", MeshFormat::ply, "plx\n", "line 1: does not begin with ply"},
        Bad{"PlyFormat", MeshFormat::ply, "ply\nformat ebcdic 1.0\nend_header\n",
            "line 3: its format is 'ebcdic'; ascii, binary_little_endian and binary_big_endian are read"},
        Bad{"PlyHeader", MeshFormat::ply, "ply\nformat ascii 1.0\n",
            "line 3: the file ends before end_header"},
        Bad{"PlyType", MeshFormat::ply, "ply\nformat ascii 1.0\nelement vertex 1\nproperty quad x\n",
            "line 4: 'quad' stands where a type, such as int or float, is due"},
        Bad{"PlyFlat", MeshFormat::ply,
            "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n1\n",
            "its element vertex needs one x, one y and one z"},
        Bad{"PlyCloud", MeshFormat::ply,
            "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float "
            "z\nend_header\n1 2 3\n",
            "holds 1 points but no faces"},
        Bad{"PlyThinAir", MeshFormat::ply,
            "ply\nformat ascii 1.0\nelement vertex 4000000000\nproperty float x\n"
            "property float y\nproperty float z\nend_header\n1 2 3\n",
            "claims 4000000000 of 'vertex', which the 6 bytes after its header cannot hold"},
        Bad{"PlyTooMany", MeshFormat::ply, "ply\nformat ascii 1.0\nelement vertex 4294967296\n",
            "line 3: claims '4294967296' of 'vertex'; at most 4294967294 are read"},
        Bad{"PlyCut", MeshFormat::ply, ply + "0 0 0\n1 0 0\n0 1 0\n3 0 1\n",
            "line 14: ends where a number is due"},
        Bad{"PlyNegative", MeshFormat::ply, ply + "0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n",
            "line 13: a corner's number is not a whole number from 0 to 4294967294"},
        Bad{"PlyNoSuchPoint", MeshFormat::ply, ply + "0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n",
            "face 0: names a point that is not among the 3 of the file"},
        Bad{"PlyNan", MeshFormat::ply, ply + "0 0 0\n1 nan 0\n0 1 0\n3 0 1 2\n",
            "face 0: uses the point of line 11, where 'nan' is not a number within 1e9 of the origin"},
        Bad{"PlyBinaryNan", MeshFormat::ply,
            binary_ply + bytes_of(0.f, -std::numeric_limits<float>::infinity(), 0.f, 1, 0),
            "face 0: uses point 0, where -inf is not a number within 1e9 of the origin"},
        Bad{"PlyHugeFace", MeshFormat::ply, binary_ply + bytes_of(0.f, 0.f, 0.f, 2000000000, 0, 0),
            "its numbers: at byte 24: needs 4 more bytes, but only 0 are left"}),
    [](const testing::TestParamInfo<Bad>& test) { return test.param.name; });

TEST(MeshFile, EveryShorterPrefixIsRefusedOrHasFewerLines) {
  const std::string text = ply + "0 0 0\n1 0 0\n0 1 0\n3 0 1 2";
  for (std::size_t size = 0; size < text.size(); ++size) {
    EXPECT_NE(refusal(std::string_view(text).substr(0, size), MeshFormat::ply), "was accepted") << size;
  }
  const std::string solid = facet + "endsolid";
  for (std::size_t size = 0; size < solid.size(); ++size) {
    EXPECT_NE(refusal(std::string_view(solid).substr(0, size), stl), "was accepted") << size;
  }
}

TEST(Components, WeldJoinsEqualVerticesAndLeavesOutWhatIsNothing) {
  Scene scene;
  scene.vertices = {{9, 9, 9},     {0, 0, 0}, {1, 0, 0}, {0, 1, 0},
                    {-0.0f, 0, 0}, {1, 0, 0}, {0, 0, 1}, {0.5f, 0, 0}};
  scene.indices = {1, 2, 3, 4, 5, 6, 3, 1, 5, 1, 2, 7, 1, 1, 2};
  scene.object_of_triangle.assign(5, 0);
  scene.object_count = 1;
  const WeldCounts counts = weld(scene);
  EXPECT_EQ(counts, (WeldCounts{4, 2, 1, 0}));
  EXPECT_EQ(scene.vertices, (std::vector<glm::vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}));
  EXPECT_EQ(scene.indices, (std::vector<std::uint32_t>{0, 1, 2, 0, 1, 3}));
  EXPECT_EQ(weld(scene), WeldCounts{}) << "nothing is left to do";
}

TEST(Components, DoublesOfOtherObjectsStay) {
  Scene scene;
  scene.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  scene.indices = {0, 1, 2, 2, 1, 0, 0, 1, 2};
  scene.object_of_triangle = {0, 1, 1};
  scene.object_count = 2;
  EXPECT_EQ(weld(scene), (WeldCounts{0, 0, 1, 0}));
  EXPECT_EQ(scene.object_of_triangle, (std::vector<std::uint32_t>{0, 1}));
}

TEST(Components, CrowdedEdgesAreCountedAndKept) {
  Scene scene;
  scene.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, -1, 0}};
  scene.indices = {0, 1, 2, 0, 1, 3, 1, 0, 4};
  scene.object_of_triangle.assign(3, 0);
  scene.object_count = 1;
  EXPECT_EQ(weld(scene), (WeldCounts{0, 0, 0, 1}));
  EXPECT_EQ(scene.indices.size(), 9u);
}

TEST(Components, ToleranceJoinsWithTheFirstInReachAndDoesNotDrift) {
  Scene scene;  // a row of points 0.6 apart, each a corner of a tall triangle
  for (const float sign : {1.f, -1.f}) {
    for (std::uint32_t i = 0; i < 6; ++i) {
      scene.vertices.insert(scene.vertices.end(),
                            {{sign * .6f * static_cast<float>(i), 0, 0}, {0, 50, sign * 90}, {0, 90, 10}});
    }
  }
  for (std::uint32_t i = 0; i < 36; ++i) scene.indices.push_back(i);
  for (std::uint32_t i = 0; i < 12; ++i) scene.object_of_triangle.push_back(i);
  scene.object_count = 12;
  weld(scene, 1);
  std::set<float> places;
  for (const glm::vec3& p : scene.vertices) {
    if (p.y == 0) places.insert(p.x);
  }
  EXPECT_EQ(places, (std::set<float>{0, 1.2f, 2.4f, -1.2f, -2.4f}));
  for (const float bad : {-1.f, 1e-9f, std::numeric_limits<float>::quiet_NaN()}) {
    EXPECT_THROW(weld(scene, bad), std::invalid_argument);
  }
}

TEST(Components, AreNumberedByTheirFirstTriangleAndKeepGlassApart) {
  Scene scene;
  for (int i = 0; i < 9; ++i) scene.vertices.emplace_back(i, i * i, 0);
  scene.indices = {0, 1, 2, 3, 4, 5, 2, 6, 7, 5, 8, 4};
  scene.object_of_triangle = {0, 1, 2, 1};
  scene.object_count = 3;
  Scene glass = scene, single = scene;
  split_into_components(scene);
  EXPECT_EQ(scene.object_of_triangle, (std::vector<std::uint32_t>{0, 1, 0, 1}));
  EXPECT_EQ(scene.object_count, 2u);
  EXPECT_TRUE(scene.see_through.empty());
  glass.see_through = {0, 0, 1};
  split_into_components(glass);
  EXPECT_EQ(glass.object_of_triangle, (std::vector<std::uint32_t>{0, 1, 2, 1}));
  EXPECT_EQ(glass.see_through, (std::vector<std::uint8_t>{0, 0, 1}));
  single.see_through = {0, 1, 0};
  split_into_triangles(single);
  EXPECT_EQ(single.object_of_triangle, (std::vector<std::uint32_t>{0, 1, 2, 3}));
  EXPECT_EQ(single.see_through, (std::vector<std::uint8_t>{0, 1, 0, 1}));
}

TEST(AnyScene, TakesLevelsAndSceneFiles) {
  const TemporaryFolder folder;
  tiny::Quake quake;
  quake.shaders = {{0, 1}, {0, 0x20000001}};
  quake.faces[1].shader = 1;  // a triangle of glass over half of face 0
  write_file(folder / "one.bsp", quake.bytes());
  using enum AnySceneOptions::Objects;
  AnySceneOptions options;
  const AnyScene faces = read_any_scene(folder / "one.bsp");
  EXPECT_EQ(faces.file.scene.object_count, 5u);
  EXPECT_EQ(faces.file.scene.see_through, (std::vector<std::uint8_t>{0, 1, 0, 0, 0}));
  EXPECT_EQ(faces.file.provenance, "one.bsp, Quake 3 (IBSP 46)");
  EXPECT_EQ(faces.welded, WeldCounts{});
  options.objects = components;
  const AnyScene parts = read_any_scene(folder / "one.bsp", options);
  EXPECT_EQ(parts.file.scene.object_count, 2u) << "what is opaque all touches";
  EXPECT_EQ(parts.file.scene.see_through, (std::vector<std::uint8_t>{0, 1}));
  EXPECT_EQ(parts.file.scene.object_of_triangle.size(), 36u);

  SceneFile city = make_city({});
  write_scene(folder / "city.scene.h5", city);
  EXPECT_TRUE(read_any_scene(folder / "city.scene.h5").file.tree.has_value());
  const SceneFile split = read_any_scene(folder / "city.scene.h5", options).file;
  EXPECT_FALSE(split.tree.has_value());
  EXPECT_EQ(split.cells.corners, city.cells.corners);
  EXPECT_EQ(split.scene.object_of_triangle, city.scene.object_of_triangle);
  options.placement.y_up = true;
  EXPECT_THROW(read_any_scene(folder / "city.scene.h5", options), std::invalid_argument);
  EXPECT_ANY_THROW(read_any_scene(folder / "no.bsp"));
}

}  // namespace
}  // namespace vismat
