// The verbs that reorder, difference, merge and compress matrices, and those that undo it.
#include <nlohmann/json.hpp>
#include <set>

#include "tests/cli/program_fixture.h"
#include "tests/sanitized.h"

namespace vismat {
namespace {

TEST_F(Program, CompressesReadsANodeAndRestores) {
  write("in.bsp.h5", ring_of_clusters(60));
  vismat_succeeds("tree in.bsp.h5 --nodes -o nodes.bsp.h5");
  const Dataset nodes = dataset("nodes.bsp.h5");
  for (const std::string codec : {"bitmap", "gzip", "zach0", "zach3-huffman", "zach4-range"}) {
    vismat_succeeds("encode nodes.bsp.h5 -o x.vmat --codec " + codec);
    vismat_succeeds("decode x.vmat -o back.bsp.h5");
    const Dataset back = dataset("back.bsp.h5");
    EXPECT_EQ(back.matrix, nodes.matrix) << codec;
    EXPECT_EQ(back.guarantee, Guarantee::exact) << codec;
    EXPECT_EQ(vismat("node x.vmat 0").code == 0, codec.starts_with("zach")) << codec;
  }
}

TEST_F(Program, ReadsRowsAndNodesOverATreeOfRows) {
  const Dataset before = ring_of_clusters(60);
  write("in.bsp.h5", before);
  vismat_succeeds("order in.bsp.h5 --columns best --rows greedy -o ordered.bsp.h5");
  vismat_succeeds("tree ordered.bsp.h5 --side rows --by sets -o sets.bsp.h5");
  for (const std::string name : {"ordered", "sets"}) {  // the first gets a tree by its boxes
    for (const std::string codec : {"gotsman1", "gotsman3", "gotsman3-context"}) {
      vismat_succeeds("encode " + name + ".bsp.h5 -o x.vmat --codec " + codec);
      vismat_succeeds("decode x.vmat -o back.bsp.h5");
      EXPECT_EQ(dataset("back.bsp.h5").matrix, before.matrix) << codec;
      EXPECT_EQ(vismat("row x.vmat 17").out, printed_row(before.matrix, 17)) << codec;
      const Finished node = vismat("node x.vmat 0 --ids");
      EXPECT_TRUE(node.out.starts_with("node 0: sees 60 of 60 objects; 2 children"))
          << node.out << node.error;
    }
  }
  Dataset bare = before;
  bare.row_bounds.clear();
  write("bare.bsp.h5", bare);
  expect_refusal("encode bare.bsp.h5 --codec gotsman3 -o y.vmat", "vismat tree --side rows --by sets");
}

// What is known of rows and columns goes with the matrix through every verb, and comes back where a verb is undone.
TEST_F(Program, CarriesTheSourceMapThroughEveryVerb) {
  Dataset before = ring_of_clusters(60);
  before.source.row_tree.reset();
  for (std::uint32_t i = 0; i < 60; ++i) {
    before.source.row_names.push_back("cell " + std::to_string(i));
    before.source.column_names.push_back("wall " + std::to_string(i % 7));
    before.source.column_levels.push_back({i / 2, i % 2});
  }
  write("in.bsp.h5", before);
  const auto run = [&](const std::string& words) { ASSERT_EQ(vismat_succeeds(words).code, 0); };
  // order, encode, decode: all of it comes back.
  run("order in.bsp.h5 --columns best --symmetric -o ordered.bsp.h5");
  run("encode ordered.bsp.h5 -o x.vmat");
  EXPECT_TRUE(contains(vismat("info x.vmat").out, "order of both"));
  run("decode x.vmat -o out.bsp.h5");
  EXPECT_EQ(dataset("out.bsp.h5").source, before.source);
  EXPECT_EQ(dataset("out.bsp.h5").matrix, before.matrix);
  // Differences, coded, decoded and undone, of an ordered matrix: its order, too.
  run("deltas ordered.bsp.h5 -o deltas.bsp.h5");
  run("encode deltas.bsp.h5 -o x.vmat");
  run("decode x.vmat --as-stored -o out.bsp.h5");
  EXPECT_EQ(dataset("out.bsp.h5").source, dataset("deltas.bsp.h5").source);
  run("deltas --undo out.bsp.h5 -o cells.bsp.h5");
  EXPECT_EQ(dataset("cells.bsp.h5").source, dataset("ordered.bsp.h5").source);
  EXPECT_EQ(dataset("cells.bsp.h5").matrix, dataset("ordered.bsp.h5").matrix);
  // Nodes: differences of them keep the tree.
  run("tree in.bsp.h5 --nodes -o nodes.bsp.h5");
  run("deltas nodes.bsp.h5 -o deltas.bsp.h5");
  run("deltas --undo deltas.bsp.h5 -o out.bsp.h5");
  EXPECT_EQ(dataset("out.bsp.h5").source, dataset("nodes.bsp.h5").source);
  expect_refusal("encode deltas.bsp.h5 --codec zach0 -o x.vmat", "holds differences");
  run("tree in.bsp.h5 -o out.bsp.h5");
  run("deltas out.bsp.h5 -o deltas.bsp.h5");  // of objects: the nodes above what appears or vanishes
  run("encode deltas.bsp.h5 --codec zach0 -o x.vmat");
  run("decode x.vmat -o out.bsp.h5");
  run("encode out.bsp.h5 --codec zach3-range -o x.vmat");
  expect_refusal("tree deltas.bsp.h5 --side rows --by sets -o none.bsp.h5", "holds differences");
  // Merged and expanded: the names are the source's all the time.
  run("merge in.bsp.h5 --lost .05 --side both -o out.bsp.h5");
  EXPECT_EQ(dataset("out.bsp.h5").source.column_names, before.source.column_names);
  run("encode out.bsp.h5 -o x.vmat");
  run("decode x.vmat -o ordered.bsp.h5");
  run("merge --expand ordered.bsp.h5 -o out.bsp.h5");
  EXPECT_EQ(dataset("out.bsp.h5").source.row_names, before.source.row_names);
  EXPECT_EQ(dataset("out.bsp.h5").source.column_levels, before.source.column_levels);
}

// Kept inputs of the fuzzer, written by the program of 2026 as version 3.
TEST_F(Program, DecodesVersion3AndRefusesItElsewhere) {
  const std::filesystem::path data = VISMAT_TEST_DATA "/fuzz/container";
  const std::string suffix = ".v3.vmat";
  const auto take = [&](const std::string& name, const char* as) {
    std::filesystem::copy_file(data / name, folder / as, std::filesystem::copy_options::overwrite_existing);
  };
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(data)) names.insert(entry.path().filename());
  std::size_t files = 0;
  for (const std::string& name : names) {
    if (!name.ends_with(suffix) || name.starts_with("name-tail")) continue;
    if (++files % 4 != 0 && test::sanitized) continue;  // the fuzzer of containers begins with all of them
    const std::string now = name.substr(0, name.size() - suffix.size()) + ".vmat";
    take(name, "old.vmat");
    ASSERT_EQ(vismat_succeeds("decode old.vmat --as-stored -o old.bsp.h5").code, 0) << name;
    if (!std::filesystem::exists(data / now))
      continue;  // what is not written any more: differences over a tree of their lists
    take(now, "now.vmat");
    ASSERT_EQ(vismat_succeeds("decode now.vmat --as-stored -o now.bsp.h5").code, 0) << name;
    EXPECT_EQ(dataset("old.bsp.h5"), dataset("now.bsp.h5")) << name;
  }
  EXPECT_GT(files, 25u);
  take("delimiter.v3.vmat", "old.vmat");
  for (const std::string words :
       {"row old.vmat 0", "node old.vmat 0", "info old.vmat", "verify old.vmat old.vmat"})
    expect_refusal(
        words, "version 3; this program reads version 4: 'vismat decode' reads version 3, then encode again");
}

TEST_F(Program, OrdersAndTellsHowFarFromTheBound) {
  const Dataset before = ring_of_clusters(60);
  write("in.bsp.h5", before);
  ASSERT_EQ(vismat_succeeds("order in.bsp.h5 --columns best --rows greedy --json o.json -o out.bsp.h5").code,
            0);
  const auto json = nlohmann::json::parse(contents("o.json"));
  const auto number = [&](const char* key) { return json[key].get<std::uint64_t>(); };
  EXPECT_LE(number("bound"), number("runs_after"));
  EXPECT_LT(number("runs_after"), number("runs_before"));
  EXPECT_GT(number("peak_bytes"), 0u);
  const Dataset after = dataset("out.bsp.h5");
  ASSERT_TRUE(after.source.row_order && after.source.column_order);
  EXPECT_EQ(permute(before.matrix, *after.source.row_order, *after.source.column_order), after.matrix);
}

TEST_F(Program, OrdersOutOfCoreAsInMemory) {
  write("in.bsp.h5", ring_of_clusters(60));
  vismat_succeeds("order in.bsp.h5 --columns best -o a.bsp.h5 --memory 1G");
  const std::string few = vismat("order in.bsp.h5 --columns best -o c.bsp.h5 --memory 1000").error;
  const std::string words = "best needs about ";
  ASSERT_TRUE(contains(few, words)) << few;
  const std::uint64_t least = std::stoull(few.substr(few.find(words) + words.size())) + 1;
  vismat_succeeds("order in.bsp.h5 --columns best -o b.bsp.h5 --memory " + std::to_string(least));
  EXPECT_EQ(contents("a.bsp.h5"), contents("b.bsp.h5"));
  EXPECT_EQ(folder.entries(), 3u);
  expect_refusal("order in.bsp.h5 --columns best -o c.bsp.h5 --memory 1000", words);
  expect_refusal("order in.bsp.h5 --columns exact-tour -o d.bsp.h5 --memory 1000", "best goes out of core");
}

TEST_F(Program, TakesDifferencesAndUndoesThem) {
  Dataset before = ring_of_clusters(60);
  before.row_neighbours = VisibilityMatrix::from_rows(std::vector<std::vector<std::uint32_t>>(60), 60);
  write("in.bsp.h5", before);
  for (const std::string neighbours : {"auto", "given", "boxes", "tree"}) {
    const Finished run = vismat_succeeds("deltas in.bsp.h5 -o deltas.bsp.h5 --neighbours " + neighbours);
    const bool none = neighbours == "auto" || neighbours == "given";  // all cells alone
    EXPECT_TRUE(contains(
        run.out, none ? "0 between 60 view cells, 60 from outside" : "between 60 view cells, 1 from outside"))
        << run.out;
    EXPECT_EQ(dataset("deltas.bsp.h5").rows_are, "boundary list");
    if (test::sanitized && (neighbours == "given" || neighbours == "boxes"))
      continue;  // as the other of the two
    vismat_succeeds("order deltas.bsp.h5 --columns identity --rows greedy -o moved.bsp.h5");
    for (const std::string name : {"deltas", "moved"}) {
      vismat_succeeds("deltas --undo " + name + ".bsp.h5 -o out.bsp.h5");
      const Dataset after = dataset("out.bsp.h5");
      EXPECT_EQ(after.matrix, before.matrix);
      EXPECT_EQ(after.column_bounds, before.column_bounds);
      EXPECT_EQ(after.guarantee, Guarantee::exact);
    }
    vismat_succeeds("encode deltas.bsp.h5 --codec rows-quick -o x.vmat");
    vismat_succeeds("decode x.vmat -o out.bsp.h5");
    const Dataset lists = dataset("deltas.bsp.h5"), back = dataset("out.bsp.h5");
    EXPECT_EQ(back.source.boundaries, lists.source.boundaries);
    EXPECT_EQ(in_source_numbers(back).matrix, lists.matrix);
    for (const std::uint32_t list : {0u, lists.matrix.shape().rows - 1}) {
      std::string expected;
      for (const std::uint32_t id : lists.matrix.row(list)) expected += std::to_string(id) + "\n";
      EXPECT_EQ(vismat_succeeds("row x.vmat " + std::to_string(list)).out, expected);
    }
    const std::string info = vismat("info deltas.bsp.h5").out;
    EXPECT_TRUE(contains(info, "\nboundaries       ")) << info;
  }
}

TEST_F(Program, RefusesDifferencesThatCannotBe) {
  write("in.bsp.h5", ring_of_clusters(60));
  write("bare.mtx", ring_of_clusters(60));
  vismat_succeeds("deltas in.bsp.h5 -o deltas.bsp.h5");
  Dataset wrong = dataset("deltas.bsp.h5");
  const auto [rows, columns] = wrong.matrix.shape();
  wrong.matrix = VisibilityMatrix::from_rows(std::vector<std::vector<std::uint32_t>>(rows, {7}), columns);
  write("damaged.bsp.h5", wrong);
  const auto refuses = [&](const std::string& words, const std::string& why) {
    expect_refusal("deltas " + words, why);
  };
  refuses("in.bsp.h5 -o out.bsp.h5 --neighbours given",
          "in.bsp.h5: does not say which view cells are neighbours");
  refuses("bare.mtx -o out.bsp.h5 --neighbours boxes", "bare.mtx: has no boxes for its rows");
  refuses("in.bsp.h5 -o out.mtx", "out.mtx: has no place for the boundaries");
  refuses("in.bsp.h5 -o no/folder.bsp.h5", "no/folder.bsp.h5");
  refuses("deltas.bsp.h5 -o out.bsp.h5", "deltas.bsp.h5: holds differences already");
  refuses("--undo in.bsp.h5 -o out.bsp.h5", "in.bsp.h5: holds no boundaries");
  refuses("--undo damaged.bsp.h5 -o out.bsp.h5", "damaged.bsp.h5: boundary 0, outside to cell 0: column 7");
  refuses("--undo deltas.bsp.h5 -o out.bsp.h5 --neighbours tree", "--neighbours");
  refuses("in.bsp.h5 -o out.bsp.h5 --neighbours walls", "--neighbours");
}

TEST_F(Program, MergesAndVerifies) {
  const Dataset before = ring_of_clusters(60);
  write("in.bsp.h5", before);
  for (const std::string side : {"cells", "objects", "both"}) {
    const Finished run =
        vismat_succeeds("merge in.bsp.h5 --lost 0.05 --seed 7 -o merged.bsp.h5 --side " + side);
    EXPECT_TRUE(
        dataset("merged.bsp.h5").provenance.ends_with(side + " merged by pairs, 0.05 lost at most, seed 7"));
    vismat_succeeds("order merged.bsp.h5 --columns best --rows best -o ordered.bsp.h5");
    vismat_succeeds("encode ordered.bsp.h5 -o merged.vmat");
    vismat_succeeds("decode merged.vmat -o decoded.bsp.h5");
    vismat_succeeds("merge --expand decoded.bsp.h5 -o all.mtx");
    for (const std::string lossy :
         {"merged.bsp.h5", "ordered.bsp.h5", "merged.vmat", "decoded.bsp.h5", "all.mtx"}) {
      const std::string verified = vismat_succeeds("verify " + lossy + " in.bsp.h5").out;
      // The same loss, however it is stored, and what merge told.
      ASSERT_TRUE(contains(verified, "added")) << verified;
      EXPECT_TRUE(contains(run.out, verified.substr(verified.find("added")))) << run.out << verified;
    }
    EXPECT_LT(dataset("merged.bsp.h5").matrix.ones(), before.matrix.ones());
    // A row of the file under the source's numbers.
    EXPECT_EQ(vismat("row merged.vmat 17").out, printed_row(dataset("all.mtx").matrix, 17));
    expect_refusal("row merged.vmat 60", "no row 60");
  }
}

TEST_F(Program, VerifyFindsWhatIsHidden) {
  const Dataset before = ring_of_clusters(60);
  Dataset hides = before;
  std::vector<std::vector<std::uint32_t>> rows(60);
  for (std::uint32_t r = 0; r < 60; ++r)
    rows[r].assign(before.matrix.row(r).begin(), before.matrix.row(r).end());
  const std::uint32_t column = rows[31][4];
  rows[31].erase(rows[31].begin() + 4);
  hides.matrix = VisibilityMatrix::from_rows(rows, 60);
  write("in.bsp.h5", before);
  write("hides.bsp.h5", hides);
  write("small.bsp.h5", ring_of_clusters(50));
  expect_refusal(
      "verify hides.bsp.h5 in.bsp.h5",
      "hides.bsp.h5: hides 1 visible entries, the first in row 31, column " + std::to_string(column) + "\n");
  expect_refusal("verify small.bsp.h5 in.bsp.h5",
                 "small.bsp.h5: stands for 50 x 50, but the original has 60 x 60");
  expect_refusal("merge in.bsp.h5 -o out.mtx", "out.mtx: has no place for the map");
  expect_refusal("merge in.bsp.h5 -o out.bsp.h5 --method luck",
                 "'luck' is no grouping method; there are seeds, pairs");
  expect_refusal("merge in.bsp.h5 -o out.bsp.h5 --lost 1.5", "--lost");
  expect_refusal("merge --expand in.bsp.h5 -o out.bsp.h5", "nothing in it was merged");
  vismat_succeeds("verify in.bsp.h5 hides.bsp.h5");
}

}  // namespace
}  // namespace vismat
