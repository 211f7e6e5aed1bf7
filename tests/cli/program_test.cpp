// The program as a user meets it: help, refusals, Ctrl-C.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "matrix/base/random.h"
#include "matrix/files/dataset_file.h"
#include "tests/matrix/temporary_folder.h"

namespace vismat {
namespace {

std::string contents(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

struct Finished {
  int status = 0;  // as waitpid tells it
  std::string out, error;
  int code() const { return WIFEXITED(status) ? WEXITSTATUS(status) : -1; }
};

// Runs vismat as the leader of a process group, as a shell does; Ctrl-C after `patience`, if that is not zero.
Finished vismat_program(std::vector<std::string> words, std::chrono::microseconds patience = {}) {
  const TemporaryFolder folder;
  const std::string out = folder / "out", error = folder / "error";
  words.insert(words.begin(), VISMAT_PROGRAM);
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  const pid_t child = ::fork();
  if (child == 0) {
    ::setpgid(0, 0);
    ::dup2(::open(out.c_str(), O_CREAT | O_WRONLY, 0600), STDOUT_FILENO);
    ::dup2(::open(error.c_str(), O_CREAT | O_WRONLY, 0600), STDERR_FILENO);
    ::execv(arguments[0], arguments.data());
    ::_exit(127);
  }
  ::setpgid(child, child);  // whichever of the two is first
  if (patience.count() > 0) {
    std::this_thread::sleep_for(patience);
    ::kill(-child, SIGINT);
  }
  Finished run;
  ::waitpid(child, &run.status, 0);
  run.out = contents(out);
  run.error = contents(error);
  return run;
}

// Exit 1 and one line that says why.
void expect_refusal(const std::vector<std::string>& words, const std::string& why) {
  const Finished run = vismat_program(words);
  EXPECT_EQ(run.code(), 1) << why;
  EXPECT_EQ(run.out, "");
  EXPECT_NE(run.error.find(why), std::string::npos) << run.error;
  EXPECT_EQ(std::count(run.error.begin(), run.error.end(), '\n'), 1) << run.error;
}

std::vector<std::string> verbs() {
  std::istringstream help(vismat_program({"--help"}).out);
  std::vector<std::string> names;
  std::string line;
  while (std::getline(help, line) && line.find("Subcommands:") == std::string::npos) {
  }
  while (std::getline(help, line) && line.rfind("  ", 0) == 0) {
    std::istringstream words(line);
    names.emplace_back();
    words >> names.back();
  }
  return names;
}

TEST(Program, HelpNamesEveryVerb) {
  const std::vector<std::string> expected = {"import", "city",    "cells", "dense-city", "plant",  "generate",
                                             "see",    "tree",    "order", "deltas",     "encode", "decode",
                                             "node",   "convert", "info",  "merge",      "verify"};
  const auto found = verbs();
  for (const std::string& verb : expected)
    EXPECT_NE(std::find(found.begin(), found.end(), verb), found.end()) << verb;
  EXPECT_NE(vismat_program({"--help"}).out.find("Example: vismat "), std::string::npos);
}

TEST(Program, EveryVerbsHelpHasAnExample) {
  for (const std::string& verb : verbs()) {
    const Finished run = vismat_program({verb, "--help"});
    EXPECT_EQ(run.code(), 0) << verb;
    EXPECT_NE(run.out.find("Example: vismat " + verb), std::string::npos) << verb;
    EXPECT_EQ(run.error, "") << verb;
  }
}

TEST(Program, RefusesInOneLine) {
  const TemporaryFolder folder;
  const std::string missing = folder / "missing.bsp.h5";
  const std::string text = folder / "text.bsp.h5", nowhere = folder / "no/folder.mtx";
  std::ofstream(text) << "this is no matrix";
  std::vector<std::vector<std::string>> wrong = {{}, {"no-such-verb"}, {"--no-such-option"}};
  for (const std::string& verb : verbs()) {
    wrong.push_back({verb, "--no-such-option"});
    for (const std::string& input : {missing, text}) {
      wrong.push_back({verb, input});
      wrong.push_back({verb, input, "-o", folder / "result.mtx"});
    }
  }
  wrong.push_back({"city", "--size", "many", "-o", folder / "result.scene.h5"});
  wrong.push_back({"city", "--size", "4", "-o", folder / "no/folder.scene.h5"});
  wrong.push_back({"cells", missing, "--cells", "grid:4m", "-o", folder / "result.scene.h5"});
  for (const auto& words : wrong) {
    const Finished run = vismat_program(words);
    std::string command = "vismat";
    for (const std::string& word : words) command += " " + word;
    EXPECT_EQ(run.code(), 1) << command;
    EXPECT_EQ(run.out, "") << command;
    EXPECT_EQ(run.error.rfind("vismat: ", 0), 0u) << command << "\n" << run.error;
    EXPECT_EQ(std::count(run.error.begin(), run.error.end(), '\n'), 1) << command << "\n" << run.error;
    EXPECT_EQ(folder.entries(), 1u) << command << " left a file";
  }
}

TEST(Program, MakesScenesOfMeshes) {
  const TemporaryFolder folder;
  const std::string mesh = folder / "two.obj", scene = folder / "two.scene.h5",
                    triangles = folder / "three.scene.h5", bad = folder / "bad.obj",
                    flat = folder / "flat.OBJ", none = folder / "none.scene.h5";
  std::ofstream(mesh)
      << "v 0 0 0\nv 100 0 0\nv 100 200 0\nv 0 200 0\nf 1 2 3 4\nv 500 0 0\nv 600 0 0\nv 500 9 9\n"
         "f 5 6 7\nf 7 6 5\nf 1 1 2\n";
  std::ofstream(bad) << "v 0 0 0\nv 1 0 0\nv 0 nan 0\nf 1 2 3\n";
  std::ofstream(flat) << "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n";
  const Finished made = vismat_program({"scene", mesh, "--scale", "0.01", "--up", "y", "-o", scene});
  EXPECT_EQ(made.code(), 0) << made.error;
  EXPECT_EQ(made.out, scene +
                          ": 2 objects, 3 triangles, 7 vertices; 1 triangles without area left out; 1 double "
                          "triangles left out\n");
  const std::string info = vismat_program({"info", scene}).out;
  EXPECT_NE(info.find("two.obj, 0.01 m a unit, y up, objects are connected components"), std::string::npos)
      << info;
  const Finished split = vismat_program({"scene", scene, "--objects", "one-a-triangle", "-o", triangles});
  EXPECT_EQ(split.out, triangles + ": 3 objects, 3 triangles, 7 vertices\n") << split.error;
  const std::size_t files = folder.entries();
  expect_refusal({"scene", bad, "-o", none},
                 "bad.obj: line 3: a coordinate is not a number within 1e9 of the origin");
  expect_refusal({"scene", flat, "-o", none}, "flat.OBJ: none of its 1 triangles has an area");
  expect_refusal({"scene", mesh, "--scale", "1e30", "-o", none},
                 "two.obj: a coordinate is farther than 1e9 m");
  expect_refusal({"scene", mesh, "--scale", "-1", "-o", none}, "a scene's scale is a number above 0");
  expect_refusal({"scene", mesh, "--weld", "-1", "-o", none}, "the tolerance is 0 or between 1e-6 and 1e9");
  expect_refusal({"scene", scene, "--scale", "2", "-o", none},
                 "two.scene.h5: its lengths and its up are known");
  expect_refusal({"scene", mesh, "--objects", "groups", "-o", none}, "--objects");
  expect_refusal({"scene", folder / "no.pk3:maps/a.bsp", "-o", none}, "no.pk3");
  EXPECT_EQ(folder.entries(), files) << "something was written";
}

// A matrix of clusters that see their neighbours, over a tree: what `tree` needs to begin with.
Dataset ring_of_clusters(std::uint32_t count) {
  Dataset dataset;
  std::vector<std::vector<std::uint32_t>> rows(count);
  for (std::uint32_t r = 0; r < count; ++r) {
    const auto at = static_cast<float>(r * 7 % count);
    dataset.row_bounds.push_back({{at, 0, 0}, {at + 1, 1, 1}});
    for (std::uint32_t c = 0; c < count; ++c) {
      const std::uint32_t apart = (c * 7 % count + count - r * 7 % count) % count;
      if (apart < 9 || apart > count - 9) rows[r].push_back(c);
    }
  }
  dataset.column_bounds = dataset.row_bounds;
  dataset.matrix = VisibilityMatrix::from_rows(rows, count);
  dataset.guarantee = Guarantee::exact;
  return dataset;
}

TEST(Program, MakesViewCells) {
  const TemporaryFolder folder;
  const std::string city = folder / "city.scene.h5", cells = folder / "cells.scene.h5";
  ASSERT_EQ(vismat_program({"city", "--size", "2", "-o", city}).code(), 0);
  for (const std::string how : {"file", "grid:5", "ground:0", "octree:24:3"}) {
    const Finished run = vismat_program({"cells", city, "--cells", how, "-o", cells});
    EXPECT_EQ(run.code(), 0) << how << run.error;
    EXPECT_NE(run.out.find(" view cells\n"), std::string::npos) << how << run.out;
    EXPECT_EQ(run.out.find("evaluated") != std::string::npos, how.starts_with("octree")) << run.out;
    EXPECT_EQ(vismat_program({"info", cells}).code(), 0) << how;
  }
}

TEST(Program, CompressesReadsANodeAndRestores) {
  const TemporaryFolder folder;
  write_dataset(folder / "in.bsp.h5", ring_of_clusters(60));
  ASSERT_EQ(vismat_program({"tree", folder / "in.bsp.h5", "--nodes", "-o", folder / "nodes.bsp.h5"}).code(),
            0);
  const Dataset nodes = read_dataset(folder / "nodes.bsp.h5");
  for (const auto& [codec, over_tree] : std::vector<std::pair<std::string, bool>>{{"bitmap", false},
                                                                                  {"gzip", false},
                                                                                  {"zach0", true},
                                                                                  {"zach3-huffman", true},
                                                                                  {"zach4-range", true}}) {
    const Finished encoded =
        vismat_program({"encode", folder / "nodes.bsp.h5", "--codec", codec, "-o", folder / "x.vmat"});
    ASSERT_EQ(encoded.code(), 0) << encoded.error;
    ASSERT_EQ(vismat_program({"decode", folder / "x.vmat", "-o", folder / "back.bsp.h5"}).code(), 0);
    const Dataset back = read_dataset(folder / "back.bsp.h5");
    EXPECT_EQ(back.matrix, nodes.matrix) << codec;
    EXPECT_EQ(back.guarantee, Guarantee::exact) << codec;
    const Finished node = vismat_program({"node", folder / "x.vmat", "0"});
    EXPECT_EQ(node.code() == 0, over_tree) << codec << node.error;
  }
}

TEST(Program, ReadsRowsAndNodesOverATreeOfRows) {
  const TemporaryFolder folder;
  const Dataset before = ring_of_clusters(60);
  write_dataset(folder / "in.bsp.h5", before);
  ASSERT_EQ(vismat_program({"order", folder / "in.bsp.h5", "--columns", "best", "--rows", "greedy", "-o",
                            folder / "ordered.bsp.h5"})
                .code(),
            0);
  ASSERT_EQ(vismat_program({"tree", folder / "ordered.bsp.h5", "--side", "rows", "--by", "sets", "-o",
                            folder / "sets.bsp.h5"})
                .code(),
            0);
  for (const std::string name : {"ordered.bsp.h5", "sets.bsp.h5"}) {  // the first gets a tree by its boxes
    for (const std::string codec : {"gotsman1", "gotsman3", "gotsman3-context"}) {
      const Finished encoded =
          vismat_program({"encode", folder / name, "--codec", codec, "-o", folder / "x.vmat"});
      ASSERT_EQ(encoded.code(), 0) << encoded.error;
      ASSERT_EQ(vismat_program({"decode", folder / "x.vmat", "-o", folder / "back.bsp.h5"}).code(), 0);
      EXPECT_EQ(read_dataset(folder / "back.bsp.h5").matrix, before.matrix) << codec;
      const Finished row = vismat_program({"row", folder / "x.vmat", "17"});
      std::string ids;
      for (const std::uint32_t id : before.matrix.row(17)) ids += std::to_string(id) + "\n";
      EXPECT_EQ(row.out, ids) << codec << row.error;
      const Finished node = vismat_program({"node", folder / "x.vmat", "0", "--ids"});
      EXPECT_EQ(node.out.rfind("node 0: sees 60 of 60 objects; 2 children", 0), 0u) << node.out << node.error;
    }
  }
  Dataset bare = before;
  bare.row_bounds.clear();
  write_dataset(folder / "bare.bsp.h5", bare);
  const Finished refused =
      vismat_program({"encode", folder / "bare.bsp.h5", "--codec", "gotsman3", "-o", folder / "y.vmat"});
  EXPECT_EQ(refused.code(), 1);
  EXPECT_NE(refused.error.find("vismat tree --side rows --by sets"), std::string::npos) << refused.error;
}

// What is known of rows and columns goes with the matrix through every verb, and comes back where a verb is undone.
TEST(Program, CarriesTheSourceMapThroughEveryVerb) {
  const TemporaryFolder folder;
  const std::string in = folder / "in.bsp.h5", ordered = folder / "ordered.bsp.h5", file = folder / "x.vmat",
                    out = folder / "out.bsp.h5", deltas = folder / "deltas.bsp.h5";
  Dataset before = ring_of_clusters(60);
  before.source.row_tree.reset();
  for (std::uint32_t i = 0; i < 60; ++i) {
    before.source.row_names.push_back("cell " + std::to_string(i));
    before.source.column_names.push_back("wall " + std::to_string(i % 7));
    before.source.column_levels.push_back({i / 2, i % 2});
  }
  write_dataset(in, before);
  const auto run = [](const std::vector<std::string>& words) {
    const Finished done = vismat_program(words);
    ASSERT_EQ(done.code(), 0) << done.error;
  };
  // order, encode, decode: all of it comes back.
  run({"order", in, "--columns", "best", "--symmetric", "-o", ordered});
  run({"encode", ordered, "-o", file});
  EXPECT_NE(vismat_program({"info", file}).out.find("order of both"), std::string::npos);
  run({"decode", file, "-o", out});
  EXPECT_EQ(read_dataset(out).source, before.source);
  EXPECT_EQ(read_dataset(out).matrix, before.matrix);
  // Differences, coded, decoded and undone, of an ordered matrix: its order, too.
  run({"deltas", ordered, "-o", deltas});
  run({"encode", deltas, "-o", file});
  run({"decode", file, "--as-stored", "-o", out});
  EXPECT_EQ(read_dataset(out).source, read_dataset(deltas).source);
  run({"deltas", "--undo", out, "-o", folder / "cells.bsp.h5"});
  EXPECT_EQ(read_dataset(folder / "cells.bsp.h5").source, read_dataset(ordered).source);
  EXPECT_EQ(read_dataset(folder / "cells.bsp.h5").matrix, read_dataset(ordered).matrix);
  // Nodes: differences of them keep the tree.
  run({"tree", in, "--nodes", "-o", folder / "nodes.bsp.h5"});
  run({"deltas", folder / "nodes.bsp.h5", "-o", deltas});
  run({"deltas", "--undo", deltas, "-o", out});
  EXPECT_EQ(read_dataset(out).source, read_dataset(folder / "nodes.bsp.h5").source);
  expect_refusal({"encode", deltas, "--codec", "zach0", "-o", file}, "holds differences");
  run({"tree", in, "-o", out});
  run({"deltas", out, "-o", deltas});  // of objects: the nodes above what appears or vanishes
  run({"encode", deltas, "--codec", "zach0", "-o", file});
  run({"decode", file, "-o", out});
  run({"encode", out, "--codec", "zach3-range", "-o", file});
  expect_refusal({"tree", deltas, "--side", "rows", "--by", "sets", "-o", deltas}, "holds differences");
  // Merged and expanded: the names are the source's all the time.
  run({"merge", in, "--lost", ".05", "--side", "both", "-o", out});
  EXPECT_EQ(read_dataset(out).source.column_names, before.source.column_names);
  run({"encode", out, "-o", file});
  run({"decode", file, "-o", ordered});
  run({"merge", "--expand", ordered, "-o", out});
  EXPECT_EQ(read_dataset(out).source.row_names, before.source.row_names);
  EXPECT_EQ(read_dataset(out).source.column_levels, before.source.column_levels);
}

// Kept inputs of the fuzzer, written by the program of 2026 as version 3.
TEST(Program, DecodesVersion3AndRefusesItElsewhere) {
  const TemporaryFolder folder;
  const std::filesystem::path data = std::filesystem::path(VISMAT_TEST_DATA) / "fuzz/container";
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(data)) {
    const std::string old = entry.path(), name = entry.path().filename();
    if (!name.ends_with(".v3.vmat") || name.starts_with("name-tail")) continue;
    ++files;
    const std::string now = data / (name.substr(0, name.size() - 8) + ".vmat");
    ASSERT_EQ(vismat_program({"decode", old, "--as-stored", "-o", folder / "old.bsp.h5"}).code(), 0) << name;
    if (!std::filesystem::exists(now))
      continue;  // what is not written any more: differences over a tree of their lists
    ASSERT_EQ(vismat_program({"decode", now, "--as-stored", "-o", folder / "now.bsp.h5"}).code(), 0) << name;
    EXPECT_EQ(read_dataset(folder / "old.bsp.h5"), read_dataset(folder / "now.bsp.h5")) << name;
  }
  EXPECT_GT(files, 25u);
  const std::string old = data / "delimiter.v3.vmat";
  for (const std::vector<std::string>& words : std::vector<std::vector<std::string>>{
           {"row", old, "0"}, {"node", old, "0"}, {"info", old}, {"verify", old, old}})
    expect_refusal(
        words, "version 3; this program reads version 4: 'vismat decode' reads version 3, then encode again");
}

TEST(Program, CountsTheTrianglesThatAreDrawn) {
  const TemporaryFolder folder;
  const std::string scene = folder / "city.scene.h5", seen = folder / "city.bsp.h5",
                    table = folder / "table.csv";
  ASSERT_EQ(vismat_program({"city", "--size", "4", "-o", scene}).code(), 0);
  ASSERT_EQ(vismat_program({"see", scene, "--objects", "-o", seen}).code(), 0);
  const Finished run = vismat_program({"triangles", scene, seen, "-o", table});
  EXPECT_EQ(run.code(), 0) << run.error;
  EXPECT_NE(run.out.find("less back faces"), std::string::npos);
  std::ifstream lines(table);
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(line, "cell,objects,triangles,at_level_of_detail,facing");
  unsigned cells = 0;
  while (std::getline(lines, line)) {
    std::array<std::uint64_t, 5> n{};
    ASSERT_EQ(std::sscanf(line.c_str(), "%lu,%lu,%lu,%lu,%lu", &n[0], &n[1], &n[2], &n[3], &n[4]), 5) << line;
    EXPECT_EQ(n[0], cells++);
    EXPECT_GE(n[2], n[3]);
    EXPECT_GE(n[3], n[4]);
    EXPECT_GT(n[4], 0u);
  }
  EXPECT_EQ(cells, read_dataset(seen).matrix.shape().rows);
  const Finished wrong = vismat_program({"triangles", scene, seen, "--field-of-view", "180"});
  EXPECT_EQ(wrong.code(), 1);
  EXPECT_NE(wrong.error.find("field of view"), std::string::npos);
}

TEST(Program, OrdersAndTellsHowFarFromTheBound) {
  const TemporaryFolder folder;
  const Dataset before = ring_of_clusters(60);
  write_dataset(folder / "in.bsp.h5", before);
  const Finished run = vismat_program({"order", folder / "in.bsp.h5", "--columns", "best", "--rows", "greedy",
                                       "--json", folder / "o.json", "-o", folder / "out.bsp.h5"});
  ASSERT_EQ(run.code(), 0) << run.error;
  const auto json = nlohmann::json::parse(contents(folder / "o.json"));
  EXPECT_LE(json["bound"].get<std::uint64_t>(), json["runs_after"].get<std::uint64_t>());
  EXPECT_LT(json["runs_after"].get<std::uint64_t>(), json["runs_before"].get<std::uint64_t>());
  EXPECT_GT(json["peak_bytes"].get<std::uint64_t>(), 0u);
  const Dataset after = read_dataset(folder / "out.bsp.h5");
  ASSERT_TRUE(after.source.row_order && after.source.column_order);
  EXPECT_EQ(permute(before.matrix, *after.source.row_order, *after.source.column_order), after.matrix);
}

TEST(Program, TakesDifferencesAndUndoesThem) {
  const TemporaryFolder folder;
  Dataset before = ring_of_clusters(60);
  before.row_neighbours = VisibilityMatrix::from_rows(std::vector<std::vector<std::uint32_t>>(60), 60);
  const std::string in = folder / "in.bsp.h5", deltas = folder / "deltas.bsp.h5", out = folder / "out.bsp.h5";
  write_dataset(in, before);
  for (const std::string neighbours : {"auto", "given", "boxes", "tree"}) {
    const Finished run = vismat_program({"deltas", in, "-o", deltas, "--neighbours", neighbours});
    ASSERT_EQ(run.code(), 0) << run.error;
    const bool none = neighbours == "auto" || neighbours == "given";  // all cells alone
    EXPECT_NE(run.out.find(none ? "0 between 60 cells, 60 from outside" : "between 60 cells, 1 from outside"),
              std::string::npos)
        << run.out;
    EXPECT_EQ(read_dataset(deltas).rows_are, "boundary list");
    ASSERT_EQ(vismat_program({"deltas", "--undo", deltas, "-o", out}).code(), 0);
    const Dataset after = read_dataset(out);
    EXPECT_EQ(after.matrix, before.matrix);
    EXPECT_EQ(after.column_bounds, before.column_bounds);
    EXPECT_EQ(after.guarantee, Guarantee::exact);
    const std::string info = vismat_program({"info", deltas}).out;
    EXPECT_NE(info.find("\nboundaries       "), std::string::npos) << info;
  }
}

TEST(Program, RefusesDifferencesThatCannotBe) {
  const TemporaryFolder folder;
  Dataset cells = ring_of_clusters(60);
  const std::string in = folder / "in.bsp.h5", bare = folder / "bare.mtx", deltas = folder / "deltas.bsp.h5",
                    damaged = folder / "damaged.bsp.h5", out = folder / "out.bsp.h5";
  write_dataset(in, cells);
  write_dataset(bare, cells);
  ASSERT_EQ(vismat_program({"deltas", in, "-o", deltas}).code(), 0);
  Dataset wrong = read_dataset(deltas);
  wrong.matrix = VisibilityMatrix::from_rows(
      std::vector<std::vector<std::uint32_t>>(wrong.matrix.shape().rows, {7}), wrong.matrix.shape().columns);
  write_dataset(damaged, wrong);
  const auto refused = [&](const std::vector<std::string>& words, const std::string& why) {
    expect_refusal(words, why);
    EXPECT_EQ(folder.entries(), 4u);
  };
  refused({"deltas", in, "-o", out, "--neighbours", "given"}, "in.bsp.h5: does not say which rows touch");
  refused({"deltas", bare, "-o", out, "--neighbours", "boxes"}, "bare.mtx: has no boxes of its rows");
  refused({"deltas", in, "-o", folder / "out.mtx"}, "out.mtx: Matrix Market has no place for the boundaries");
  refused({"deltas", in, "-o", folder / "no/folder.bsp.h5"}, "no/folder.bsp.h5");
  refused({"deltas", deltas, "-o", out}, "deltas.bsp.h5: holds differences already");
  refused({"deltas", "--undo", in, "-o", out}, "in.bsp.h5: holds no boundaries");
  refused({"deltas", "--undo", damaged, "-o", out},
          "damaged.bsp.h5: boundary 0, outside to cell 0: column 7");
  refused({"deltas", "--undo", deltas, "-o", out, "--neighbours", "tree"}, "--neighbours");
  refused({"deltas", in, "-o", out, "--neighbours", "walls"}, "--neighbours");
}

TEST(Program, MergesAndVerifies) {
  const TemporaryFolder folder;
  const std::string in = folder / "in.bsp.h5", merged = folder / "merged.bsp.h5",
                    ordered = folder / "ordered.bsp.h5", file = folder / "merged.vmat",
                    decoded = folder / "decoded.bsp.h5", all = folder / "all.mtx";
  const Dataset before = ring_of_clusters(60);
  write_dataset(in, before);
  for (const std::string side : {"cells", "objects", "both"}) {
    const Finished run = vismat_program({"merge", in, "--lost", "0.05", "--side", side, "-o", merged});
    ASSERT_EQ(run.code(), 0) << run.error;
    ASSERT_EQ(vismat_program({"order", merged, "--columns", "best", "--rows", "best", "-o", ordered}).code(),
              0);
    ASSERT_EQ(vismat_program({"encode", ordered, "-o", file}).code(), 0);
    ASSERT_EQ(vismat_program({"decode", file, "-o", decoded}).code(), 0);
    ASSERT_EQ(vismat_program({"merge", "--expand", decoded, "-o", all}).code(), 0);
    for (const std::string& lossy : {merged, ordered, file, decoded, all}) {
      const Finished verified = vismat_program({"verify", lossy, in});
      EXPECT_EQ(verified.code(), 0) << verified.error;
      // The same loss, however it is stored, and what merge told.
      const std::string loss = verified.out.substr(verified.out.find("added"));
      EXPECT_NE(run.out.find(loss), std::string::npos) << run.out << verified.out;
    }
    EXPECT_LT(read_dataset(merged).matrix.ones(), before.matrix.ones());
    // A row of the file under the source's numbers.
    const VisibilityMatrix expanded = read_dataset(all).matrix;
    std::string row;
    for (const std::uint32_t id : expanded.row(17)) row += std::to_string(id) + "\n";
    EXPECT_EQ(vismat_program({"row", file, "17"}).out, row);
    EXPECT_EQ(vismat_program({"row", file, "60"}).code(), 1);
  }
}

TEST(Program, VerifyFindsWhatIsHidden) {
  const TemporaryFolder folder;
  const Dataset before = ring_of_clusters(60);
  Dataset hides = before;
  std::vector<std::vector<std::uint32_t>> rows(60);
  for (std::uint32_t r = 0; r < 60; ++r)
    rows[r].assign(before.matrix.row(r).begin(), before.matrix.row(r).end());
  const std::uint32_t column = rows[31][4];
  rows[31].erase(rows[31].begin() + 4);
  hides.matrix = VisibilityMatrix::from_rows(rows, 60);
  write_dataset(folder / "in.bsp.h5", before);
  write_dataset(folder / "hides.bsp.h5", hides);
  write_dataset(folder / "small.bsp.h5", ring_of_clusters(50));
  const auto refused = [&](const std::vector<std::string>& words, const std::string& why) {
    expect_refusal(words, why);
    EXPECT_EQ(folder.entries(), 3u);
  };
  refused({"verify", folder / "hides.bsp.h5", folder / "in.bsp.h5"},
          "hides.bsp.h5: hides 1 visible entries, the first in row 31, column " + std::to_string(column));
  refused({"verify", folder / "small.bsp.h5", folder / "in.bsp.h5"},
          "small.bsp.h5: stands for 50 x 50, but the original has 60 x 60");
  refused({"merge", folder / "in.bsp.h5", "-o", folder / "out.mtx"},
          "out.mtx: Matrix Market has no place for the map");
  refused({"merge", folder / "in.bsp.h5", "--method", "luck", "-o", folder / "out.bsp.h5"},
          "'luck' is no grouping");
  refused({"merge", folder / "in.bsp.h5", "--lost", "1.5", "-o", folder / "out.bsp.h5"}, "--lost");
  refused({"merge", "--expand", folder / "in.bsp.h5", "-o", folder / "out.bsp.h5"},
          "nothing in it was merged");
  EXPECT_EQ(vismat_program({"verify", folder / "in.bsp.h5", folder / "hides.bsp.h5"}).code(), 0);
}

TEST(Program, VerifyChecksAMatrixAgainstItsScene) {
  const TemporaryFolder folder;
  const std::string scene = folder / "city.scene.h5", in = folder / "in.bsp.h5",
                    seen = folder / "seen.bsp.h5", blind = folder / "blind.bsp.h5";
  ASSERT_EQ(vismat_program({"city", "--size", "4", "-o", scene}).code(), 0);
  ASSERT_EQ(vismat_program({"see", scene, "--objects", "-o", in, "--seen", seen}).code(), 0);
  for (const auto& [matrix, claim] : {std::pair(in, "hidden"), std::pair(seen, "seen")}) {
    const Finished run = vismat_program({"verify", matrix, "--witness", scene, "--samples", "30"});
    EXPECT_EQ(run.code(), 0) << run.error;
    EXPECT_NE(run.out.find(std::string("\n") + claim + ' '), std::string::npos) << run.out;
    EXPECT_NE(run.out.find(" 30         30              0\n"), std::string::npos) << run.out;
  }

  Dataset dataset = read_dataset(in);  // now it claims that nothing is seen from anywhere
  const Shape shape = dataset.matrix.shape();
  dataset.matrix =
      VisibilityMatrix::from_rows(std::vector<std::vector<std::uint32_t>>(shape.rows), shape.columns);
  dataset.guarantee = Guarantee::conservative;
  dataset.sight_lines.clear();
  dataset.degree_of_visibility.clear();
  write_dataset(blind, dataset);
  const Finished refuted = vismat_program({"verify", blind, "--witness", scene, "--samples", "2"});
  EXPECT_EQ(refuted.code(), 1);
  EXPECT_NE(refuted.error.find("entries are not confirmed to be hidden, the first in row "),
            std::string::npos)
      << refuted.error;
  expect_refusal({"verify", in}, "name the ORIGINAL matrix, or a scene with --witness");
  dataset.guarantee = Guarantee::unknown;
  write_dataset(blind, dataset);
  expect_refusal({"verify", blind, "--witness", scene}, "blind.bsp.h5: claims neither");
}

TEST(Program, OrdersOutOfCoreAsInMemory) {
  const TemporaryFolder folder;
  write_dataset(folder / "in.bsp.h5", ring_of_clusters(60));
  const auto order = [&](const std::string& method, const std::string& out, const std::string& memory) {
    return vismat_program(
        {"order", folder / "in.bsp.h5", "--columns", method, "-o", folder / out, "--memory", memory});
  };
  const Finished in_core = order("best", "a.bsp.h5", "1G"), few = order("best", "c.bsp.h5", "1000");
  ASSERT_EQ(in_core.code(), 0) << in_core.error;
  EXPECT_EQ(few.code(), 1);
  const std::string words = "best needs about ";
  const auto at = few.error.find(words);
  ASSERT_NE(at, std::string::npos) << few.error;
  const std::string least = std::to_string(std::stoull(few.error.substr(at + words.size())) + 1);
  const Finished out_of_core = order("best", "b.bsp.h5", least);
  ASSERT_EQ(out_of_core.code(), 0) << out_of_core.error;
  EXPECT_EQ(contents(folder / "a.bsp.h5"), contents(folder / "b.bsp.h5"));
  EXPECT_EQ(folder.entries(), 3u);
  EXPECT_NE(order("exact-tour", "d.bsp.h5", "1000").error.find("best goes out of core"), std::string::npos);
}

// Ctrl-C falls at ever later moments, until the program is through before it: whatever it was doing then, what
// stood under the final name is whole, either the old file or the new one, and nothing lies beside it.
void interrupt_everywhere(const TemporaryFolder& folder, std::size_t files_before,
                          const std::vector<std::string>& words, const std::filesystem::path& result) {
  using namespace std::chrono_literals;
  vismat_program(words);
  const std::string whole = contents(result);
  ASSERT_FALSE(whole.empty());
  int interrupted = 0;
  bool through = false;
  for (auto patience = 500us; !through; patience += patience / 5) {
    std::ofstream(result, std::ios::trunc) << "old";
    const Finished run = vismat_program(words, patience);
    through = run.code() == 0;
    interrupted += run.code() == 130;
    const std::string left = contents(result);
    EXPECT_TRUE(left == whole || (!through && left == "old")) << left.size() << " bytes";
    EXPECT_EQ(folder.entries(), files_before + 1) << "after " << patience.count() << " us";
  }
  EXPECT_GT(interrupted, 0);
}

TEST(Program, LeavesNoPartialMatrixOnCtrlC) {
  Random random(1);
  std::vector<std::vector<std::uint32_t>> rows(1500);
  for (auto& row : rows) {
    for (std::uint32_t c = random.below(9); c < 3000; c += 1 + random.below(9)) row.push_back(c);
  }
  Dataset dataset;
  dataset.matrix = VisibilityMatrix::from_rows(rows, 3000);
  const TemporaryFolder folder;
  const std::string input = folder / "in.bsp.h5";
  write_dataset(input, dataset);
  for (const char* name : {"out.bsp.h5", "out.mtx"}) {
    const std::string output = folder / name;
    interrupt_everywhere(folder, 1, {"convert", input, "-o", output}, output);
    std::filesystem::remove(output);
  }
}

TEST(Program, LeavesNoPartialSceneOnCtrlC) {
  const TemporaryFolder folder;
  const std::string output = folder / "out.scene.h5";
  interrupt_everywhere(folder, 0, {"city", "--size", "16", "-o", output}, output);
}

}  // namespace
}  // namespace vismat
