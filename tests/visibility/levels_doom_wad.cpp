#include <gtest/gtest.h>

#include "matrix/base/byte_reader.h"
#include "tests/visibility/levels_tiny.h"
#include "visibility/levels/doom_wad.h"

namespace vismat {
namespace {

using test::refusal;
using tiny::Doom;

std::string refused(const Doom& doom, std::string_view map = "MAP07") {
  return refusal([&] { parse_doom_map(doom.bytes(), map); });
}

TEST(DoomWad, SetBitsOfRejectAreHidden) {
  const Level level = parse_doom_map(Doom().bytes(), "MAP07");
  EXPECT_EQ(level.cells, VisibilityMatrix::from_rows({{0, 1}, {0, 1, 2}, {1, 2}}, 3));
  EXPECT_EQ(level.cells_are, "sector");
}

TEST(DoomWad, RejectCountsRowByRowFromTheLowestBit) {
  Doom doom;
  doom.reject = {0b00000010, 0b1};  // bit 1: sector 0 sees not 1; bit 8: 2 sees not itself
  EXPECT_EQ(parse_doom_map(doom.bytes(), "MAP07").cells,
            VisibilityMatrix::from_rows({{0, 2}, {0, 1, 2}, {0, 1}}, 3));
}

TEST(DoomWad, BitsThatAreMissingHideNothing) {
  Doom doom;
  doom.reject = {0xff};
  EXPECT_EQ(parse_doom_map(doom.bytes(), "MAP07").cells, VisibilityMatrix::from_rows({{}, {}, {2}}, 3));
  doom.reject = {};
  EXPECT_EQ(parse_doom_map(doom.bytes(), "MAP07").cells.ones(), 9u);
  doom.left_out = {"REJECT"};
  EXPECT_EQ(parse_doom_map(doom.bytes(), "MAP07").cells.ones(), 9u);
}

TEST(DoomWad, BoxesSpanASectorsLines) {
  const Level level = parse_doom_map(Doom().bytes(), "MAP07");
  const std::vector<Box> boxes = {{{0, 0, 0}, {2, 2, 1}}, {{2, 0, 0}, {4, 2, 4}}, {{4, 0, -2}, {6, 2, 2}}};
  EXPECT_EQ(level.cell_bounds, boxes);
  EXPECT_EQ(level.cell_neighbours, VisibilityMatrix::from_rows({{1}, {0, 2}, {1}}, 3));
}

TEST(DoomWad, TreeComesFromTheNodes) {
  Doom doom;
  EXPECT_EQ(parse_doom_map(doom.bytes(), "MAP07").cell_tree,
            ObjectTree::from_parents({ObjectTree::none, 0, 1, 1, 0},
                                     {ObjectTree::none, ObjectTree::none, 0, 1, 2}, 3));
  doom.nodes.clear();
  EXPECT_EQ(parse_doom_map(doom.bytes(), "MAP07").cell_tree.size(), 0u);
}

TEST(DoomWad, ExtendedNodesLeaveNoTree) {
  auto bytes = Doom().bytes();
  const std::size_t nodes = 12 + 10 * 14 + 5 * 30 + 8 * 4 + 3 * 12 + 3 * 4;
  for (const char* magic : {"xNd4", "XNOD", "ZNOD", "XGLN", "ZGLN"}) {
    std::memcpy(bytes.data() + nodes, magic, 4);
    const Level level = parse_doom_map(bytes, "MAP07");
    EXPECT_EQ(level.cell_tree.size(), 0u);
    EXPECT_EQ(level.cells.ones(), 7u);
  }
}

TEST(DoomWad, DatasetHasNoFaces) {
  Level level = parse_doom_map(Doom().bytes(), "map07");
  level.name = "x.wad:map07";
  EXPECT_EQ(level_dataset(level, LevelMatrix::cells, LevelTree::bounds).guarantee, Guarantee::conservative);
  EXPECT_EQ(refusal([&] { level_dataset(level, LevelMatrix::faces, LevelTree::none); }),
            "x.wad:map07: a Doom level without faces; take the matrix of cells");
  level.cell_tree = {};
  EXPECT_EQ(refusal([&] { level_dataset(level, LevelMatrix::cells, LevelTree::level); }),
            "x.wad:map07: has no tree of its own that can be read; take --tree bounds");
}

TEST(DoomWad, ListsMaps) {
  Doom doom;
  doom.map = "E1M1";
  const auto maps = doom_maps(doom.bytes());
  ASSERT_EQ(maps.size(), 1u);
  EXPECT_EQ(maps[0].name, "E1M1");
  EXPECT_EQ(maps[0].bytes, 10 * 14 + 5 * 30 + 8 * 4 + 3 * 12 + 3 * 4 + 2 * 28 + 3 * 26 + 2u);
}

TEST(DoomWad, EveryShorterPrefixIsRefused) {
  const auto bytes = Doom().bytes();
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_THROW(parse_doom_map(std::span(bytes).first(size), "MAP07"), FormatError) << size;
    EXPECT_THROW(doom_maps(std::span(bytes).first(size)), FormatError) << size;
  }
}

TEST(DoomWad, RefusesMapsThatAreNotThere) {
  EXPECT_EQ(refused(Doom(), "MAP08"), "no map MAP08; there are MAP07");
  Doom doom;
  doom.left_out = {"THINGS"};
  EXPECT_EQ(refused(doom), "no map MAP07; there is none");
}

TEST(DoomWad, RefusesOtherFormats) {
  Doom doom;
  doom.magic = "WAD2";
  EXPECT_EQ(refused(doom), "WAD header: does not begin with IWAD or PWAD");
  doom = {};
  doom.extra_lump = "BEHAVIOR";
  EXPECT_EQ(refused(doom), "MAP07: is in Hexen's format; only Doom's is read");
  auto bytes = Doom().bytes();
  const std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  std::memcpy(bytes.data() + text.find("THINGS"), "TEXTMAP", 7);
  EXPECT_EQ(refusal([&] { parse_doom_map(bytes, "MAP07"); }),
            "MAP07: is in the text format UDMF; only Doom's binary maps are read");
}

TEST(DoomWad, RefusesADirectoryOutsideTheFile) {
  auto bytes = Doom().bytes();
  const auto refused_with = [&](std::size_t at, std::int32_t value) {
    auto changed = bytes;
    std::memcpy(changed.data() + at, &value, 4);
    return refusal([&] { parse_doom_map(changed, "MAP07"); });
  };
  const std::string end = " lies outside the file of " + std::to_string(bytes.size()) + " bytes";
  EXPECT_EQ(refused_with(8, 0x7fffffff), "WAD header: a directory of 11 lumps at offset 2147483647" + end);
  EXPECT_EQ(refused_with(8, -1), "WAD header: a directory of 11 lumps at offset -1" + end);
  EXPECT_EQ(refused_with(4, 0x7fffffff).substr(0, 48), "WAD header: a directory of 2147483647 lumps at o");
  EXPECT_EQ(refused_with(4, -1).substr(0, 40), "WAD header: a directory of -1 lumps at o");
  const std::size_t lines_entry = bytes.size() - 9 * 16;
  EXPECT_EQ(refused_with(lines_entry + 4, 0x7fffffff),
            "WAD directory: lump 2 (LINEDEFS): 2147483647 bytes at offset 12 lie outside the file of " +
                std::to_string(bytes.size()) + " bytes");
  EXPECT_EQ(refused_with(lines_entry + 4, 13),
            "MAP07: LINEDEFS: 13 bytes are no whole number of 14-byte records");
}

TEST(DoomWad, RefusesBadReferences) {
  Doom doom;
  doom.lines[2].to = 8;
  EXPECT_EQ(refused(doom), "MAP07: LINEDEFS: record 2: vertex 8 of only 8");
  doom = {};
  doom.lines[3].left = 5;
  EXPECT_EQ(refused(doom), "MAP07: LINEDEFS: record 3: sidedef 5 of only 5");
  doom = {};
  doom.sector_of_side[4] = 3;
  EXPECT_EQ(refused(doom), "MAP07: SIDEDEFS: record 4: sector 3 of only 3");
  doom = {};
  doom.first_segs[1] = 3;
  EXPECT_EQ(refused(doom), "MAP07: SSECTORS: record 1: seg 3 of only 3");
  doom = {};
  doom.segs[2] = {0, 1};
  EXPECT_EQ(refused(doom), "MAP07: SEGS: record 2: side 1 of line 0 does not exist");
  doom.segs[2] = {10, 0};
  EXPECT_EQ(refused(doom), "MAP07: SEGS: record 2: side 0 of line 10 does not exist");
  doom = {};
  doom.nodes[0][0] = 1;
  EXPECT_EQ(refused(doom), "MAP07: NODES: node 1 is reached twice; a tree has no cycles");
  doom.nodes[0][0] = 0x8003;
  EXPECT_EQ(refused(doom), "MAP07: NODES: a child is leaf 3 of only 3");
}

TEST(DoomWad, RefusesMissingLumpsAndSectors) {
  for (const char* lump : {"LINEDEFS", "SIDEDEFS", "VERTEXES", "SEGS", "SSECTORS", "SECTORS"}) {
    Doom doom;
    doom.left_out = {lump};
    EXPECT_EQ(refused(doom), std::string("MAP07: ") + lump + ": is missing");
  }
  Doom doom;
  doom.sectors.clear();
  EXPECT_EQ(refused(doom), "MAP07: SECTORS: 0 sectors; a map has 1 to 65536");
  doom.sectors.resize(65537);
  EXPECT_EQ(refused(doom), "MAP07: SECTORS: 65537 sectors; a map has 1 to 65536");
  doom.sectors.resize(
      20000);  // half a megabyte of sectors without a reject table would list 400 million pairs
  EXPECT_EQ(refused(doom),
            "MAP07: REJECT: 399999998 pairs of 20000 sectors are not rejected; at most 268435456 are taken");
}

}  // namespace
}  // namespace vismat
