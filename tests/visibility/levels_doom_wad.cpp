#include <gtest/gtest.h>

#include <algorithm>

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
  for (const char* magic : {"xNd4", "XNOD", "ZNOD", "XGLN", "ZGLN", "XGL2", "ZGL2", "XGL3", "ZGL3"}) {
    for (const std::size_t at : {nodes, nodes - 3 * 4}) {  // NODES, SSECTORS
      auto changed = bytes;
      std::memcpy(changed.data() + at, magic, 4);
      const Level level = parse_doom_map(changed, "MAP07");
      EXPECT_EQ(level.cell_tree.size(), 0u);
      EXPECT_EQ(level.cells.ones(), 7u);
    }
  }
}

TEST(DoomWad, ForeignLumpsArePassedOver) {
  const Level plain = parse_doom_map(Doom().bytes(), "MAP07");
  for (const char* lump : {"THINGS", "LINEDEFS", "SIDEDEFS", "VERTEXES", "SEGS", "SSECTORS", "NODES",
                           "SECTORS", "REJECT", "BLOCKMAP"}) {
    Doom doom;
    doom.foreign_before = lump;
    const Level level = parse_doom_map(doom.bytes(), "map07");
    EXPECT_EQ(level.cells, plain.cells) << lump;
    EXPECT_EQ(level.cell_tree, plain.cell_tree) << lump;
    EXPECT_TRUE(level.notes.empty()) << lump;
    const auto maps = doom_maps(doom.bytes());
    ASSERT_EQ(maps.size(), 1u) << lump;
    EXPECT_EQ(maps[0].name, "MAP07");
    EXPECT_EQ(maps[0].bytes, doom_maps(Doom().bytes())[0].bytes);
  }
}

// The lumps of both files, one after the other.
tiny::Bytes joined(const tiny::Bytes& first, const tiny::Bytes& second) {
  const auto number = [](const tiny::Bytes& wad, std::size_t at) { return number_at<std::int32_t>(wad, at); };
  tiny::Bytes bytes, directory;
  for (const tiny::Bytes* wad : {&first, &second}) {
    const auto shift = static_cast<std::int32_t>(bytes.size());
    bytes.insert(bytes.end(), wad->begin(), wad->end());
    for (std::int32_t i = 0; i < number(*wad, 4); ++i) {
      const std::size_t entry = static_cast<std::size_t>(number(*wad, 8)) + 16 * static_cast<std::size_t>(i);
      tiny::put(directory, number(*wad, entry) + shift);
      directory.insert(directory.end(), wad->begin() + static_cast<std::ptrdiff_t>(entry) + 4,
                       wad->begin() + static_cast<std::ptrdiff_t>(entry) + 16);
    }
  }
  const auto count = static_cast<std::int32_t>(directory.size() / 16),
             at = static_cast<std::int32_t>(bytes.size());
  std::memcpy(bytes.data() + 4, &count, 4);
  std::memcpy(bytes.data() + 8, &at, 4);
  bytes.insert(bytes.end(), directory.begin(), directory.end());
  return bytes;
}

TEST(DoomWad, AMapEndsWhereTheNextBegins) {
  Doom first, second;
  first.left_out = {"REJECT"};
  for (const char* name : {"MAP08", "ARENA"}) {
    second.map = name;
    const auto bytes = joined(first.bytes(), second.bytes());
    const auto maps = doom_maps(bytes);
    ASSERT_EQ(maps.size(), 2u);
    EXPECT_EQ(maps[0].name, "MAP07");
    EXPECT_EQ(maps[1].name, name);
    EXPECT_EQ(parse_doom_map(bytes, "MAP07").cells.ones(), 9u) << "not the other's REJECT";
    EXPECT_EQ(parse_doom_map(bytes, name).cells.ones(), 7u);
  }
}

TEST(DoomWad, LowerCaseNamesOfLumps) {
  auto bytes = Doom().bytes();
  for (std::size_t at = bytes.size() - 11 * 16; at < bytes.size(); at += 16) {
    for (std::size_t i = 8; i < 16; ++i) {
      const auto c = std::to_integer<char>(bytes[at + i]);
      if (c >= 'A' && c <= 'Z') bytes[at + i] = static_cast<std::byte>(c - 'A' + 'a');
    }
  }
  EXPECT_EQ(parse_doom_map(bytes, "MAP07").cells.ones(), 7u);
}

TEST(DoomWad, OnlyLumpsThatAreReadMustLieInTheFile) {
  Doom doom;
  doom.extra_lump = "DEMO1";
  for (const char* lump : {"DEMO1", "BLOCKMAP", "THINGS"}) {
    doom.outside = lump;
    auto bytes = doom.bytes();
    EXPECT_EQ(parse_doom_map(bytes, "MAP07").cells.ones(), 7u) << lump;
  }
  for (const char* lump :
       {"LINEDEFS", "SIDEDEFS", "VERTEXES", "SEGS", "SSECTORS", "NODES", "SECTORS", "REJECT"}) {
    doom.outside = lump;
    EXPECT_NE(refused(doom).find("(" + std::string(lump) + "): "), std::string::npos) << refused(doom);
    EXPECT_NE(refused(doom).find("bytes at offset 1000000 lie outside the file of "), std::string::npos);
  }
}

TEST(DoomWad, NotesSayWhatRejectLeavesVisible) {
  Doom doom;
  const auto notes = [&] { return parse_doom_map(doom.bytes(), "MAP07").notes; };
  using Lines = std::vector<std::string>;
  EXPECT_EQ(notes(), Lines());
  doom.reject = {0xff};
  EXPECT_EQ(notes(),
            Lines({"MAP07: REJECT has 1 of the 2 bytes that 3 sectors need; pairs past its end count as "
                   "visible"}));
  doom.reject = {0, 0};
  EXPECT_EQ(notes(),
            Lines({"MAP07: REJECT rejects nothing: every sector counts as visible from every other"}));
  doom.reject = {0, 0, 0};
  EXPECT_EQ(notes().size(), 1u) << "a longer lump is as good";
  const Lines none = {"MAP07 has no REJECT, so every sector counts as visible from every other"};
  doom.reject = {};
  EXPECT_EQ(notes(), none);
  doom.left_out = {"REJECT"};
  EXPECT_EQ(notes(), none);
  Level level = parse_doom_map(doom.bytes(), "MAP07");
  level.name = "x.wad:MAP07";
  EXPECT_EQ(level_dataset(level, LevelMatrix::cells, LevelTree::none).provenance,
            "x.wad:MAP07, Doom, " + none[0]);
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
  auto console = bytes;
  std::reverse(console.begin() + 4, console.begin() + 8);
  std::reverse(console.begin() + 8, console.begin() + 12);
  EXPECT_EQ(
      refusal([&] { doom_maps(console); }),
      "WAD header: its numbers have the highest byte first, as on some consoles; only files with the lowest "
      "byte first are read");
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
