// Tests levels by their place: archives, the message when something is missing, and the program around them.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "matrix/base/atomic_file.h"
#include "matrix/base/byte_reader.h"
#include "matrix/files/dataset_file.h"
#include "tests/visibility/levels_tiny.h"
#include "visibility/levels/level_file.h"
#include "visibility/levels/pk3.h"
#include "visibility/levels/quake3_bsp.h"
#include "visibility/levels/shader_script.h"

namespace vismat {
namespace {

using test::refusal;

class LevelFile : public testing::Test {
 protected:
  void SetUp() override {
    std::string name = (std::filesystem::temp_directory_path() / "vismat-levels-XXXXXX").string();
    ASSERT_NE(::mkdtemp(name.data()), nullptr);
    folder_ = name;
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  std::string write(const char* name, const tiny::Bytes& bytes) const {
    write_file(folder_ / name, bytes);
    return (folder_ / name).string();
  }
  /// The program's exit code and all it printed.
  std::pair<int, std::string> vismat(const std::string& arguments) const {
    std::FILE* pipe = ::popen(
        ("cd '" + folder_.string() + "' && '" VISMAT_PROGRAM "' " + arguments + " 2>&1").c_str(), "r");
    std::string output;
    for (int c; (c = std::fgetc(pipe)) != EOF;) output += static_cast<char>(c);
    return {WEXITSTATUS(::pclose(pipe)), output};
  }
  std::filesystem::path folder_;
};

tiny::Bytes tiny_pk3() {
  return tiny::zip(
      {{"maps/one.bsp", tiny::Quake().bytes(), true}, {"maps/one.aas", {}}, {"maps/TWO.BSP", {}}});
}

TEST_F(LevelFile, ReadsEachKind) {
  const auto quake = tiny::Quake().bytes();
  const Level direct = read_level(write("one.bsp", quake)),
              packed = read_level(write("x.pk3", tiny_pk3()) + ":maps/one.bsp"),
              doom = read_level(write("d.wad", tiny::Doom().bytes()) + ":map07");
  EXPECT_EQ(direct.name, "one.bsp");
  EXPECT_EQ(packed.name, "x.pk3:maps/one.bsp");
  EXPECT_EQ(doom.name, "d.wad:map07");
  EXPECT_EQ(direct.cells, parse_quake3_bsp(quake).cells);
  EXPECT_EQ(packed.cells, direct.cells);
  EXPECT_EQ(summary(direct),
            "Quake 3 (IBSP 46): 3 clusters, each sees 77.8 % of them on average; 5 faces of 36 triangles; a "
            "tree of 7 nodes");
  EXPECT_EQ(summary(doom), "Doom: 3 sectors, each sees 77.8 % of them on average; a tree of 5 nodes");
}

TEST(ShaderScript, TellsWhatIsSeenThrough) {
  std::set<std::string> names;
  add_see_through_shaders(
      "textures/a/Grate // comment {\n{\n surfaceparm metalsteps\n{ map a.tga\n alphaFunc GE128 } }\n"
      "textures/a/lit{{map $lightmap}{map b.tga\nblendFunc filter}}\n"
      "/* textures/a/none { */ textures/a/glow {\n{\nmap c.tga\nBLENDFUNC add\n}\n}\n"
      "textures/a/pane\n{ surfaceparm trans }\ntextures/a/wall { surfaceparm nomarks trans { map d } }",
      names);
  EXPECT_EQ(names, (std::set<std::string>{"textures/a/grate", "textures/a/glow", "textures/a/pane"}));
  for (const char* odd : {"", "}", "}}{{{", "a{{{{alphafunc", "/*", "//", "surfaceparm trans"}) {
    add_see_through_shaders(odd, names);
  }
  EXPECT_EQ(names.size(), 3u);
}

TEST(ShaderScript, WordsInQuotes) {
  std::set<std::string> names;
  add_see_through_shaders(
      "\xef\xbb\xbf\"Textures\\A/pane.tga\"\r\n{\r\n\"surfaceparm\" \"trans\"\r\n}\n"
      "\"textures/a/with {brace\"{{map \"}\"\n\"alphafunc\" GE128}}"
      "textures/a/plain { // \"\n q3map_note \"not closed\n { map x } }\n"
      "textures/a/after // \"{\n/* } \" */ {surfaceparm trans}",
      names);
  EXPECT_EQ(names, (std::set<std::string>{"textures/a/pane", "textures/a/with {brace", "textures/a/after"}));
}

TEST(ShaderScript, ForgottenBraces) {
  std::set<std::string> names;
  add_see_through_shaders(
      "textures/a/open\n{\n{ map x\n}\n"
      "textures/a/pane // after one that is not closed\n{\nsurfaceparm trans\n}\n}\n}\n"
      "textures/a/pane2{surfaceparm trans}\n"
      "textures/a/unopened\nsurfaceparm trans\n}\n"
      "textures/a/wall\n{\n{ map textures/a/b.tga\n}\nq3map_lightimage textures/a/b.tga\n{ alphafunc GE128 "
      "}\n}",
      names);
  EXPECT_EQ(names, (std::set<std::string>{"textures/a/pane", "textures/a/pane2", "textures/a/wall"}));
}

TEST_F(LevelFile, ScriptsOfItsOwnPackageCount) {
  const auto see_through = [&](const std::string& script) {
    tiny::Bytes bytes;
    tiny::put_text(bytes, script, script.size());
    return read_level(write("s.pk3", tiny::zip({{"scripts/a.shader", bytes, true},
                                                {"maps/one.bsp", tiny::Quake().bytes()}})) +
                      ":maps/one.bsp")
        .face_scene.see_through;
  };
  EXPECT_EQ(see_through("textures/base { { map a.tga alphafunc gt0 } }"), std::vector<std::uint8_t>(5, 1));
  EXPECT_TRUE(see_through("textures/other { { map a.tga alphafunc gt0 } }").empty());
}

tiny::Bytes text_bytes(std::string_view text) {
  tiny::Bytes bytes;
  tiny::put_text(bytes, text, text.size());
  return bytes;
}

TEST_F(LevelFile, ArchivesOfAnyEndingAndNamesInAnyCase) {
  const auto quake = tiny::Quake().bytes();
  std::filesystem::create_directory(folder_ / "a.pk3:b");
  const auto script = text_bytes("\"TEXTURES/Base\"\n{ surfaceparm trans }");
  for (const char* name : {"x.zip", "x.PK3", "x.pk4", "x.ZIP", "levels", "a.pk3:b/x.pk3"}) {
    const std::string file =
        write(name, tiny::zip({{"MAPS\\Deep/TWO.BSP", quake}, {"SCRIPTS/A.SHADER", script}}));
    for (const char* member : {"MAPS\\Deep/TWO.BSP", "maps/deep/two.bsp"}) {
      const std::string where = file + ":" + member;
      EXPECT_TRUE(names_level(where));
      EXPECT_EQ(read_level(where).face_scene.see_through, std::vector<std::uint8_t>(5, 1)) << where;
    }
    EXPECT_EQ(read_level(list_levels(file).at(0).where).cells.ones(), 7u);
  }
  tiny::Quake other;
  other.rows.assign(24, 0xff);
  const std::string both =
      write("both.pk3", tiny::zip({{"maps/One.bsp", quake}, {"maps/ONE.bsp", other.bytes()}}));
  EXPECT_EQ(read_level(both + ":maps/One.bsp").cells.ones(), 7u);
  EXPECT_EQ(read_level(both + ":maps/ONE.bsp").cells.ones(), 9u);
  EXPECT_EQ(
      refusal([&] { read_level(both + ":maps/one.bsp"); }),
      both +
          ":maps/one.bsp: 'maps/one.bsp' may be 'maps/One.bsp' or 'maps/ONE.bsp'; write its name exactly as "
          "in the archive");
}

TEST_F(LevelFile, ToldApartByEndingOrFirstBytes) {
  for (const char* where : {"no.bsp", "no.PK3", "no.zip", "no.wad:E1M1", "a:b/no.pk4:maps/x.bsp", "c.WAD"}) {
    EXPECT_TRUE(names_level(where)) << where;
  }
  for (const char* where : {"no.obj", "no.scene.h5", "no.obj:x", "no.bsp.h5", ""}) {
    EXPECT_FALSE(names_level(where)) << where;
  }
  EXPECT_TRUE(names_level(write("level", tiny::Quake().bytes())));
  EXPECT_FALSE(names_level(write("text", text_bytes("text"))));
  EXPECT_FALSE(names_level(folder_.string()));
}

TEST_F(LevelFile, WadsInArchives) {
  const std::string file = write("d.zip", tiny::zip({{"Maps/DOOM.WAD", tiny::Doom().bytes(), true},
                                                     {"cut.wad", text_bytes("PWAD")},
                                                     {"one.bsp", tiny::Quake().bytes()}}));
  std::vector<std::string> places;
  for (const LevelListing& level : list_levels(file)) places.push_back(level.where);
  EXPECT_EQ(places,
            (std::vector<std::string>{file + ":one.bsp", file + ":Maps/DOOM.WAD:MAP07", file + ":cut.wad"}));
  EXPECT_EQ(read_level(file + ":Maps/DOOM.WAD:MAP07").cells.ones(), 7u);
  EXPECT_EQ(read_level(file + ":maps/doom.wad:map07").name, "d.zip:maps/doom.wad:map07");
  const auto refused = [&](const char* member) { return refusal([&] { read_level(file + ":" + member); }); };
  EXPECT_EQ(refused("Maps/DOOM.WAD"),
            file + ":Maps/DOOM.WAD: holds 1 levels; name one, such as Maps/DOOM.WAD:MAP07");
  EXPECT_EQ(refused("Maps/DOOM.WAD:MAP09"), file + ":Maps/DOOM.WAD:MAP09: no map MAP09; there are MAP07");
  EXPECT_EQ(
      refused("one.bsp:MAP09"),
      file + ":one.bsp:MAP09: no member 'one.bsp:MAP09'; its levels are one.bsp, Maps/DOOM.WAD, cut.wad");
}

TEST_F(LevelFile, ADamagedMemberRefusesWhatNeedsIt) {
  auto bytes =
      tiny::zip({{"maps/one.bsp", tiny::Quake().bytes()}, {"scripts/a.shader", text_bytes("a{}//damaged")}});
  const std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  bytes[text.find("damaged")] ^= std::byte{1};
  write("x.pk3", bytes);
  EXPECT_EQ(vismat("import x.pk3:maps/one.bsp -o x.mtx --matrix faces").first, 0);
  EXPECT_EQ(vismat("info x.pk3:maps/one.bsp").first, 0);
  const std::string why = "vismat: x.pk3:maps/one.bsp: member 'scripts/a.shader': CRC error\n";
  EXPECT_EQ(vismat("scene x.pk3:maps/one.bsp -o x.scene.h5"), (std::pair{1, why}));
  EXPECT_EQ(vismat("import x.pk3:maps/one.bsp -o y.mtx --scene x.scene.h5"), (std::pair{1, why}));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "y.mtx"));
}

TEST(Pk3, RefusesAnEncryptedMember) {
  const auto bytes = tiny::zip({{"maps/one.bsp", tiny::Quake().bytes(), false, -1, true}});
  EXPECT_EQ(refusal([&] { Pk3(bytes).read("maps/one.bsp"); }),
            "member 'maps/one.bsp' is encrypted; unpack it with its password, and name the file");
}

TEST_F(LevelFile, ListsLevels) {
  const auto pk3 = list_levels(write("x.pk3", tiny_pk3()));
  ASSERT_EQ(pk3.size(), 2u);
  EXPECT_EQ(pk3[0].where, (folder_ / "x.pk3").string() + ":maps/one.bsp");
  EXPECT_EQ(pk3[0].bytes, tiny::Quake().bytes().size());
  EXPECT_EQ(pk3[1].where, (folder_ / "x.pk3").string() + ":maps/TWO.BSP");
  const auto wad = list_levels(write("d.wad", tiny::Doom().bytes()));
  ASSERT_EQ(wad.size(), 1u);
  EXPECT_EQ(wad[0].where, (folder_ / "d.wad").string() + ":MAP07");
}

TEST_F(LevelFile, NamesTheFileInEveryMessage) {
  const std::string pk3 = write("x.pk3", tiny_pk3()), wad = write("d.wad", tiny::Doom().bytes());
  const auto refused = [](const std::string& where) { return refusal([&] { read_level(where); }); };
  EXPECT_EQ(refused(pk3), pk3 + ": holds 2 levels; name one, such as " + pk3 + ":maps/one.bsp");
  EXPECT_EQ(refused(pk3 + ":maps/six.bsp"),
            pk3 + ":maps/six.bsp: no member 'maps/six.bsp'; its levels are maps/one.bsp, maps/TWO.BSP");
  const std::string one = write("one.bsp", tiny::Quake().bytes());
  EXPECT_EQ(refused(one + ":MAP01"),
            one + ":MAP01: " + one + " is one level; what stands after it names nothing");
  EXPECT_EQ(refused(wad + ":MAP99"), wad + ":MAP99: no map MAP99; there are MAP07");
  const std::string gone = (folder_ / "gone.bsp").string();
  EXPECT_EQ(refused(gone), gone + ": cannot open this level");
  EXPECT_EQ(refused(folder_.string()), folder_.string() + ": cannot open this level");
  const std::string text = write("text.bsp", tiny::bytes_of<char>({'t', 'e', 'x', 't'}));
  EXPECT_EQ(refused(text),
            text + ": begins neither as a Quake-3 level (IBSP) nor as a .wad (IWAD, PWAD) or .pk3 (PK)");
  const std::string broken = write("broken.pk3", tiny::bytes_of<char>({'P', 'K', 3, 4, 0}));
  EXPECT_EQ(
      refused(broken + ":maps/one.bsp"),
      broken + ": cannot open as .pk3: no zip archive, or cut short: the directory at its end is missing");
}

TEST_F(LevelFile, MissingMembersOfALargeArchiveListTheFirstFew) {
  std::vector<tiny::ZipMember> members;
  for (int i = 0; i < 9; ++i) members.push_back({"maps/" + std::to_string(i) + ".bsp", {}});
  const auto bytes = tiny::zip(members);
  EXPECT_EQ(
      refusal([&] { Pk3(bytes).read("x"); }),
      "no member 'x'; its levels are maps/0.bsp, maps/1.bsp, maps/2.bsp, maps/3.bsp, maps/4.bsp and 4 more");
  const auto empty = tiny::zip({{"readme", {}}});
  EXPECT_EQ(refusal([&] { Pk3(empty).read("x"); }), "no member 'x'; its levels are none");
}

TEST(Pk3, RefusesAMemberThatClaimsGigabytes) {
  const auto bytes = tiny::zip({{"maps/one.bsp", tiny::Quake().bytes(), true, 0xfffffffe}});
  EXPECT_EQ(refusal([&] { Pk3(bytes).read("maps/one.bsp"); }),
            "member 'maps/one.bsp' claims 4294967294 bytes; at most 268435456 are read");
}

TEST(Pk3, RefusesAMemberThatUnpacksToMoreThanItClaims) {
  const auto bytes = tiny::zip({{"maps/one.bsp", tiny::Bytes(std::size_t{257} << 20), true, 1000}});
  ASSERT_LT(bytes.size(), 2u << 20);
  EXPECT_EQ(refusal([&] { Pk3(bytes).read("maps/one.bsp"); }),
            "member 'maps/one.bsp' claims 1000 bytes but unpacks to more than 268435456");
}

TEST(Pk3, RefusesAMemberWhoseChecksumIsWrong) {
  auto bytes = tiny::zip({{"maps/one.bsp", tiny::Quake().bytes()}});
  bytes[200] ^= std::byte{1};
  EXPECT_EQ(refusal([&] { Pk3(bytes).read("maps/one.bsp"); }), "member 'maps/one.bsp': CRC error");
}

TEST(Pk3, EveryShorterPrefixIsRefused) {
  const auto bytes = tiny_pk3();
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_THROW(Pk3(std::span(bytes).first(size)).read("maps/one.bsp"), FormatError) << size;
  }
}

TEST_F(LevelFile, TheProgramImports) {
  write("one.bsp", tiny::Quake().bytes());
  EXPECT_EQ(
      vismat("import one.bsp -o one.bsp.h5 --matrix faces --tree level --scene one.scene.h5"),
      (std::pair{
          0, std::string("one.bsp.h5: 3 clusters x 5 faces, 80.0 % visible, a tree of 9 nodes; 1 faces in no "
                         "cluster left out\n"
                         "one.scene.h5: 5 objects, 36 triangles, 0 see-through objects; 1 billboards without "
                         "triangles; 1 faces in no cluster left out\n")}));
  EXPECT_EQ(
      vismat("import one.bsp -o nodes.bsp.h5 --nodes"),
      (std::pair{0, std::string("nodes.bsp.h5: 3 clusters x 4 nodes, 83.3 % visible, a tree of 4 nodes\n")}));
  const Dataset dataset = read_dataset(folder_ / "one.bsp.h5");
  Level level = parse_quake3_bsp(tiny::Quake().bytes());
  level.name = "one.bsp";
  EXPECT_EQ(dataset, level_dataset(level, LevelMatrix::faces, LevelTree::level));
  EXPECT_EQ(vismat("tree one.bsp.h5 -o tree.bsp.h5 --arity 2"),
            (std::pair{0, std::string("tree.bsp.h5: a tree of 9 nodes over 5 objects\n")}));
  EXPECT_EQ(read_dataset(folder_ / "tree.bsp.h5").matrix, dataset.matrix);
  EXPECT_EQ(
      vismat("tree nodes.bsp.h5 -o x.bsp.h5"),
      (std::pair{1, std::string("vismat: nodes.bsp.h5: its columns are the nodes of a tree already\n")}));
}

TEST_F(LevelFile, TheProgramCountsSeeThroughObjects) {
  write("x.zip",
        tiny::zip({{"maps/one.bsp", tiny::Quake().bytes()},
                   {"scripts/a.shader", text_bytes("\"textures/base\"\n{\nsurfaceparm trans\n}\n")}}));
  EXPECT_NE(
      vismat("import x.zip:maps/one.bsp -o x.mtx --scene x.scene.h5").second.find("5 see-through objects"),
      std::string::npos);
  const auto [code, scene] = vismat("scene x.zip:maps/one.bsp -o y.scene.h5");
  EXPECT_EQ(code, 0);
  EXPECT_NE(
      scene.find("; 5 see-through objects; 1 billboards without triangles; 1 faces in no cluster left out"),
      std::string::npos)
      << scene;
}

TEST_F(LevelFile, TheProgramTakesALevelWithoutVisibilityData) {
  tiny::Quake quake;
  quake.has_visdata = false;
  write("no_vis.bsp", quake.bytes());
  EXPECT_EQ(vismat("import no_vis.bsp -o x.mtx"),
            (std::pair{1, std::string(
                              "vismat: no_vis.bsp: lump 16 (visdata): empty: this level was compiled without "
                              "visibility data; 'vismat scene' takes its triangles, and 'vismat see' "
                              "computes what is visible\n")}));
  const auto [code, scene] = vismat("scene no_vis.bsp -o x.scene.h5");
  EXPECT_EQ(code, 0);
  EXPECT_NE(scene.find("5 objects, 36 triangles"), std::string::npos) << scene;
  const auto seen = vismat("see no_vis.bsp --cells grid:1 --region=1,1,0.5,2,2,1.5 -o x.mtx --threads 1");
  EXPECT_EQ(seen.first, 0) << seen.second;
  const auto [info_code, info] = vismat("info no_vis.bsp");
  EXPECT_EQ(info_code, 0);
  EXPECT_NE(info.find("3 clusters, without visibility data; 5 faces of 36 triangles"), std::string::npos)
      << info;
  EXPECT_NE(info.find("visibility       not in the file"), std::string::npos) << info;
}

TEST_F(LevelFile, TheProgramPrintsNothingOfLevelsItCannotRead) {
  write("cut.pk3", text_bytes("PK\3\4"));
  write("text.bsp", text_bytes("text"));
  EXPECT_EQ(vismat("info cut.pk3")
                .second.find("vismat: cut.pk3: cannot open as .pk3: no zip archive, or cut short"),
            0u);
  EXPECT_EQ(vismat("info text.bsp").second.find("vismat: text.bsp: begins neither as a Quake-3 level"), 0u);
}

TEST_F(LevelFile, TheProgramTellsOfAMapWithoutReject) {
  tiny::Doom doom;
  doom.left_out = {"REJECT"};
  write("d.wad", doom.bytes());
  const std::string note = "MAP07 has no REJECT, so every sector counts as visible from every other";
  EXPECT_EQ(
      vismat("import d.wad:MAP07 -o x.mtx --tree none"),
      (std::pair{0, "x.mtx: without boxes, neighbours\nx.mtx: 3 sectors x 3 sectors, 100.0 % visible; " +
                        note + "\n"}));
  EXPECT_NE(vismat("info d.wad:MAP07").second.find("visibility       " + note), std::string::npos);
}

TEST_F(LevelFile, TheProgramRefusesInOneLineAndWritesNothing) {
  tiny::Quake quake;
  quake.leafs[2].cluster = 3;
  write("bad.bsp", quake.bytes());
  write("d.wad", tiny::Doom().bytes());
  const auto refused = [&](const std::string& arguments, const std::string& message) {
    EXPECT_EQ(vismat(arguments + " -o out.bsp.h5"), (std::pair{1, "vismat: " + message + "\n"}));
    EXPECT_FALSE(std::filesystem::exists(folder_ / "out.bsp.h5"));
  };
  refused("import bad.bsp", "bad.bsp: lump 4 (leafs): leaf 2: cluster 3 of only 3");
  refused("import gone.bsp", "gone.bsp: cannot open this level");
  refused("import d.wad:MAP07 --matrix faces",
          "d.wad:MAP07: a Doom level without faces; take the matrix of cells");
  refused("import d.wad:MAP07 --scene s.scene.h5",
          "d.wad:MAP07: a Doom level without faces has no scene to write");
  refused("import d.wad:MAP07 --tree none --nodes", "--nodes needs a tree: --tree bounds or --tree level");
  refused("import d.wad:MAP07 --tree some", "--tree: some not in {none,bounds,level}");
}

}  // namespace
}  // namespace vismat
