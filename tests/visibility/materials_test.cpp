// What can be seen through, what becomes an object, and where map coordinates go.
#include "visibility/meshes/materials.h"

#include <gtest/gtest.h>

#include <array>
#include <string>
#include <vector>

#include "matrix/base/atomic_file.h"
#include "tests/matrix/temporary_folder.h"
#include "visibility/meshes/any_scene.h"
#include "visibility/meshes/level_faces.h"

namespace vismat {
namespace {

std::span<const std::byte> bytes_of(const std::string& text) {
  return std::as_bytes(std::span(text));
}
void write_text(const std::filesystem::path& path, const std::string& text) {
  write_file(path, bytes_of(text));
}

/// The first bytes of a PNG file: its size is 1 x 1.
std::string png(char colour_type, const std::string& chunk) {
  std::string file("\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\0\1\0\0\0\1\x08", 25);
  file += colour_type;
  file += std::string("\0\0\0crc!", 7);
  return file + std::string("\0\0\0\2", 4) + chunk + "xxcrc!" + std::string("\0\0\0\0", 4) + "IDAT";
}

TEST(Materials, WhatMtlSaysIsSeenThrough) {
  const TemporaryFolder folder;
  write_text(folder / "leaf one.png", png(6, "gAMA"));
  write_text(folder / "wall.png", png(2, "gAMA"));
  write_text(folder / "key.png", png(2, "tRNS"));
  Materials found;
  add_materials(
      bytes_of("\xef\xbb\xbf# windows\r\nnewmtl glass\r\nKd 1 1 1\r\nd 0.1\r\n"
               "newmtl tr\nTr 0.4\nnewmtl halo\nd -halo 0.5\n"
               "newmtl opaque\nd 1\nTr 0\nnewmtl both\nd 1.0\nTr 1.0\nnewmtl fence\nd 1\nmap_d fence.png\n"
               "newmtl leaf\nmap_Kd -s 1 1 1 textures\\leaf one.png\nnewmtl wall\nmap_Kd wall.png\n"
               "newmtl key\nmap_Kd key.png\nnewmtl lost\nmap_Kd lost.png\n"),
      folder / ".", found);
  const std::map<std::string, std::string> expected = {{"glass", "d 0.1"},
                                                       {"tr", "Tr 0.4"},
                                                       {"halo", "d 0.5"},
                                                       {"opaque", ""},
                                                       {"both", ""},
                                                       {"fence", "map_d"},
                                                       {"leaf", "leaf one.png has alpha"},
                                                       {"wall", ""},
                                                       {"key", "key.png has alpha"},
                                                       {"lost", ""}};
  EXPECT_EQ(found.see_through, expected);
  EXPECT_EQ(found.missing, std::vector<std::string>{"lost.png"});
}

TEST(Materials, AlphaIsToldByTheHeader) {
  std::string tga(18, '\0');
  tga[16] = 32;
  EXPECT_TRUE(has_alpha(bytes_of(tga), "a.TGA"));
  tga[16] = 24;
  EXPECT_FALSE(has_alpha(bytes_of(tga), "a.tga"));
  std::string dds(128, '\0');
  dds.replace(0, 4, "DDS ");
  EXPECT_FALSE(has_alpha(bytes_of(dds), "a.dds"));
  dds[80] = 1;
  EXPECT_TRUE(has_alpha(bytes_of(dds), "a.dds"));
  dds[80] = 4, dds.replace(84, 4, "DXT5");
  EXPECT_TRUE(has_alpha(bytes_of(dds), "a.dds"));
  EXPECT_FALSE(has_alpha(bytes_of("\xff\xd8\xff"), "a.jpg"));
  std::string webp = "RIFF\x20xxxWEBPVP8X....\x10" + std::string(10, '\0');
  EXPECT_TRUE(has_alpha(bytes_of(webp), "a.webp"));
  webp[20] = 2;
  EXPECT_FALSE(has_alpha(bytes_of(webp), "a.webp"));
  webp.replace(15, 1, "L"), webp[24] = 0x10;
  EXPECT_TRUE(has_alpha(bytes_of(webp), "a.webp"));
  for (const std::string& cut : {png(6, "gAMA"), dds, tga, webp}) {
    for (std::size_t size = 0; size < cut.size(); ++size) has_alpha(bytes_of(cut.substr(0, size)), "a.tga");
  }
}

/// Two storeys of a house, the upper one of glass, and a garden: squares of 1 m beside one another.
constexpr const char* house =
    "mtllib house.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\nv 2 1 0\nv 3 0 0\nv 3 1 0\n"
    "o house\ng walls\nusemtl brick\nf 1 2 3 4\ng panes\nusemtl glass\nf 2 5 6 3\no garden\nusemtl lawn\nf 5 "
    "7 8 6\n";

AnyScene read_house(const TemporaryFolder& folder, AnySceneOptions options) {
  write_text(folder / "house.obj", house);
  return read_any_scene(folder / "house.obj", options);
}
using Names = std::vector<std::string>;
using Objects = AnySceneOptions::Objects;

TEST(ObjectsOfTheFile, GroupsMaterialsTilesAndComponents) {
  const TemporaryFolder folder;
  write_text(folder / "house.mtl", "newmtl brick\nd 1\nnewmtl glass\nd 0.2\nnewmtl lawn\n");
  AnySceneOptions options;
  options.objects = Objects::groups;
  const Scene groups = read_house(folder, options).file.scene;
  EXPECT_EQ(groups.object_names, (Names{"house/walls", "house/panes", "garden"}));
  EXPECT_EQ(groups.see_through, (std::vector<std::uint8_t>{0, 1, 0}));
  EXPECT_EQ(groups.object_of_triangle, (std::vector<std::uint32_t>{0, 0, 1, 1, 2, 2}));

  options.objects = Objects::materials;
  EXPECT_EQ(read_house(folder, options).file.scene.object_names, (Names{"brick", "glass", "lawn"}));

  options.objects = Objects::tiles, options.tile = 2;
  const Scene tiles = read_house(folder, options).file.scene;
  EXPECT_EQ(tiles.object_names, (Names{"tile 0,0", "tile 0,0 (see-through)", "tile 1,0"}));
  options.tile = 0;
  EXPECT_THROW(read_house(folder, options), std::invalid_argument);

  options.objects = Objects::components;
  const AnyScene parts = read_house(folder, options);
  EXPECT_EQ(parts.file.scene.object_count, 3u) << "glass parts what touches it";
  EXPECT_TRUE(parts.file.scene.object_names.empty());
  EXPECT_FALSE(parts.file.opacity_unknown);
  ASSERT_EQ(parts.notes.size(), 1u);
  EXPECT_EQ(parts.notes[0], "see-through: glass (d 0.2)");
}

TEST(ObjectsOfTheFile, WithoutMaterialsAllIsOpaqueAndSaysSo) {
  const TemporaryFolder folder;
  AnySceneOptions options;
  const AnyScene lost = read_house(folder, options);
  EXPECT_TRUE(lost.file.scene.see_through.empty());
  EXPECT_TRUE(lost.file.opacity_unknown);
  EXPECT_NE(lost.notes.at(0).find("house.mtl"), std::string::npos) << lost.notes[0];
  options.see_through = "GLA.S|leaf";
  const AnyScene named = read_house(folder, options);
  EXPECT_EQ(named.file.scene.see_through, (std::vector<std::uint8_t>{0, 1, 0}));
  EXPECT_FALSE(named.file.opacity_unknown);
  options.see_through = "(";
  EXPECT_THROW(read_house(folder, options), std::invalid_argument);

  write_text(folder / "plain.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  options.see_through = "";
  options.objects = Objects::groups;
  EXPECT_THROW(read_any_scene(folder / "plain.obj", options), std::invalid_argument);
}

TEST(ObjectsOfTheFile, SolidsOfStl) {
  const TemporaryFolder folder;
  std::string stl;
  for (const std::string name : {"solid left wing", "solid"}) {
    const std::string x = name == "solid" ? "5" : "0";
    stl += name + "\nfacet normal 0 0 1\nouter loop\nvertex " + x + " 0 0\nvertex " + x +
           " 1 0\nvertex 9 9 0\nendloop\nendfacet\nend" + name + "\n";
  }
  write_text(folder / "two.stl", stl);
  AnySceneOptions options;
  options.objects = Objects::groups;
  EXPECT_EQ(read_any_scene(folder / "two.stl", options).file.scene.object_names,
            (Names{"left wing", "solid 2"}));
}

TEST(MapCoordinates, AModelFarAwayKeepsItsTriangles) {
  const TemporaryFolder folder;
  std::string obj;
  for (int y = 0; y <= 4; ++y) {
    for (int x = 0; x <= 4; ++x)
      obj += "v " + std::to_string(691000 + x * 0.25) + " " + std::to_string(5300000 + y * 0.25) + " 7\n";
  }
  for (int y = 0; y < 4; ++y) {
    for (int x = 1; x <= 4; ++x) {
      const int p = 5 * y + x;
      obj += "f " + std::to_string(p) + " " + std::to_string(p + 1) + " " + std::to_string(p + 6) + " " +
             std::to_string(p + 5) + "\n";
    }
  }
  write_text(folder / "tiles.obj", obj);
  AnySceneOptions options;
  const SceneFile moved = read_any_scene(folder / "tiles.obj", options).file;
  EXPECT_EQ(moved.scene.object_of_triangle.size(), 32u);
  EXPECT_EQ(moved.origin, (std::array<double, 3>{691000, 5300000, 0}));
  EXPECT_EQ(bounds_of(moved.scene), (Box{{0, 0, 7}, {1, 1, 7}}));
  options.placement.origin = {691000.5, 5300000, 7};
  EXPECT_EQ(bounds_of(read_any_scene(folder / "tiles.obj", options).file.scene),
            (Box{{-0.5f, 0, 0}, {0.5f, 1, 0}}));
  options.placement.origin = {0, 0, 0};
  EXPECT_LT(read_any_scene(folder / "tiles.obj", options).file.scene.object_of_triangle.size(), 32u);
}

TEST(LevelFaces, TellWhichWayUp) {
  Scene street;  // ground of 20 x 20 with a wall of 20 x 3
  street.vertices = {{0, 0, 0}, {20, 0, 0}, {20, 20, 0}, {0, 20, 0}, {20, 0, 3}, {0, 0, 3}};
  street.indices = {0, 1, 2, 0, 2, 3, 0, 1, 4, 0, 4, 5};
  street.object_of_triangle = {0, 0, 1, 1};
  street.object_count = 2;
  EXPECT_EQ(axis_of_level_faces(street), 2);
  for (glm::vec3& vertex : street.vertices) vertex = {vertex.x, vertex.z, -vertex.y};
  EXPECT_EQ(axis_of_level_faces(street), 1);
  Scene terrain;
  for (int y = 0; y < 30; ++y) {
    for (int x = 0; x < 30; ++x) terrain.vertices.emplace_back(x, y, 0.3 * ((x * 7 + y * 13) % 5));
  }
  for (std::uint32_t i = 0; i < 30 * 29; ++i) {
    if (i % 30 == 29) continue;
    for (const std::uint32_t corner : {i, i + 1, i + 31, i, i + 31, i + 30})
      terrain.indices.push_back(corner);
  }
  terrain.object_of_triangle.assign(terrain.indices.size() / 3, 0);
  terrain.object_count = 1;
  EXPECT_EQ(axis_of_level_faces(terrain), 2);
}

}  // namespace
}  // namespace vismat
