#include "matrix/files/dataset_file.h"

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <functional>

#include "matrix/base/atomic_file.h"
#include "matrix/base/byte_reader.h"
#include "matrix/base/random.h"
#include "matrix/files/binsparse.h"
#include "matrix/files/hdf5_file.h"
#include "tests/matrix/temporary_folder.h"

namespace vismat {
namespace {

Dataset full_dataset() {
  constexpr auto none = ObjectTree::none;
  Dataset dataset;
  dataset.matrix = VisibilityMatrix::from_rows({{0, 2}, {}, {1, 2}}, 3);
  dataset.rows_are = "cluster";
  dataset.columns_are = "face";
  dataset.provenance = "level oa_test.bsp, seed 7";
  dataset.guarantee = Guarantee::aggressive;
  dataset.seed = 7;
  dataset.row_bounds = {{{0, 0, 0}, {1, 1, 1}}, {{1, 0, 0}, {2, 1, 1}}, {{-3.5f, 0, 0}, {0, 1, 1e9f}}};
  dataset.column_bounds = {{{0, 0, 0}, {1, 2, 3}}, {{5, 5, 5}, {6, 6, 6}}, {{9, 9, 9}, {9, 9, 9}}};
  dataset.row_neighbours = VisibilityMatrix::from_rows({{1}, {0, 2}, {1}}, 3);
  dataset.sight_lines = {{0, 0, 0, 1, 2, 3}, {1, 1, 1, 9, 9, 9}, {-1, 0, 0, 5, 6, 5}, {0, 0, 0, 9, 9, 9}};
  dataset.degree_of_visibility = {0.5f, 0.001f, 0, 1};
  dataset.source.tree = ObjectTree::from_parents({none, 0, 0, 2, 2}, {none, 0, none, 1, 2}, 3);
  dataset.source.row_tree = ObjectTree::from_parents({none, 0, 0, 2, 2}, {none, 2, none, 0, 1}, 3);
  dataset.source.row_names = {"hall", "", "stairs"};
  dataset.source.column_names = {"floor", "T\xc3\xbcr", "lamp"};
  dataset.source.column_levels = {{0, 0}, {0, 1}, {7, 0}};
  return dataset;
}

Dataset differences() {
  Dataset dataset;
  const auto cells = VisibilityMatrix::from_rows({{0, 2}, {}, {1, 2}, {1}}, 3);
  Deltas deltas = deltas_of(cells, VisibilityMatrix::from_rows({{1}, {0, 3}, {}, {1}}, 4));
  dataset.matrix = std::move(deltas.lists);
  dataset.source.boundaries = std::move(deltas.boundaries);
  dataset.rows_are = "boundary list";
  return dataset;
}

Dataset large_dataset() {
  Random random(3);
  std::vector<std::vector<std::uint32_t>> rows(800);
  for (auto& row : rows) {
    for (std::uint32_t c = random.below(9); c < 3000; c += 1 + random.below(9)) row.push_back(c);
  }
  Dataset dataset;
  dataset.matrix = VisibilityMatrix::from_rows(rows, 3000);
  return dataset;
}

std::string reading_refusal(const std::filesystem::path& path) {
  try {
    read_dataset(path);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

TEST(Dataset, ReorderedMovesAllThatGoesByRowsAndColumns) {
  const Dataset before = full_dataset();
  const auto rows = Permutation::from_new_of_old({2, 0, 1}),
             columns = Permutation::from_new_of_old({1, 0, 2});
  const Dataset after = reordered(before, rows, columns);
  EXPECT_EQ(after.matrix, VisibilityMatrix::from_rows({{}, {0, 2}, {1, 2}}, 3));
  EXPECT_EQ(after.row_bounds[2], before.row_bounds[0]);
  EXPECT_EQ(after.column_bounds[1], before.column_bounds[0]);
  EXPECT_EQ(*after.row_neighbours, VisibilityMatrix::from_rows({{1, 2}, {0}, {0}}, 3));
  EXPECT_EQ(after.source.tree->object_of_node()[1], 1u);
  EXPECT_EQ(after.source.row_tree->object_of_node()[1], 1u);
  EXPECT_EQ(after.source.row_order, rows);

  // Back again: nothing but the record of having moved is left, and what goes by entries is gone.
  Dataset again = reordered(after, rows.inverse(), columns.inverse());
  EXPECT_TRUE(again.source.row_order->is_identity());
  EXPECT_TRUE(again.source.column_order->is_identity());
  again.source.row_order.reset();
  again.source.column_order.reset();
  EXPECT_TRUE(again.sight_lines.empty());
  again.sight_lines = before.sight_lines;
  again.degree_of_visibility = before.degree_of_visibility;
  EXPECT_EQ(again, before);
}

TEST(Dataset, ReorderedLeavesOutATreeWhoseNodesTheColumnsWere) {
  const Dataset nodes = over_nodes(full_dataset());
  const auto rows = Permutation::identity(3);
  EXPECT_TRUE(reordered(nodes, rows, Permutation::identity(5)).source.tree);
  const Dataset after = reordered(nodes, rows, Permutation::from_new_of_old({1, 0, 2, 3, 4}));
  EXPECT_FALSE(after.source.tree);
  EXPECT_FALSE(after.source.columns_are_nodes);
}

TEST(Dataset, BoundariesFindTheirListsWhereverTheseMove) {
  const Dataset before = differences();
  const auto columns = Permutation::from_new_of_old({1, 0, 2});
  const Dataset after = reordered(before, Permutation::identity(8), columns);
  EXPECT_EQ(after.source.boundaries, before.source.boundaries);
  EXPECT_EQ(cells_of({after.source.boundaries, after.matrix}),
            permute(cells_of({before.source.boundaries, before.matrix}), Permutation::identity(4), columns));
  const auto rows = Permutation::from_new_of_old({1, 7, 2, 3, 4, 5, 6, 0});
  Dataset moved = merged(before, equal_rows(before.matrix), std::nullopt);
  ASSERT_EQ(moved.matrix.shape().rows, 4u);
  moved = reordered(std::move(moved), Permutation::from_new_of_old({2, 0, 3, 1}), columns);
  const Partition still_equal = equal_rows(moved.matrix);
  moved = merged(std::move(moved), still_equal, std::nullopt);
  for (const Dataset& dataset : {reordered(before, rows, columns), moved}) {
    EXPECT_NO_THROW(check_source_map(dataset.source, dataset.matrix.shape()));
    const Dataset back = with_lists_in_place(dataset);
    EXPECT_EQ(back.matrix, after.matrix);
    EXPECT_FALSE(back.source.list_rows);
    EXPECT_EQ(back.source.boundaries, before.source.boundaries);
    EXPECT_EQ(in_source_numbers(dataset).matrix, before.matrix);
    EXPECT_EQ(dataset.source.row_order, before.source.row_order);
  }
}

TEST(Dataset, MergedUnitesAllThatGoesByRowsAndColumns) {
  const Dataset before = full_dataset();
  const auto pair = Partition::from_group_of_member({0, 1, 0});
  const Dataset rows = merged(before, pair, {}), columns = merged(before, {}, pair);
  EXPECT_EQ(rows.matrix, VisibilityMatrix::from_rows({{0, 1, 2}, {}}, 3));
  EXPECT_EQ(rows.row_bounds[0], (Box{{-3.5f, 0, 0}, {1, 1, 1e9f}}));
  EXPECT_EQ(*rows.row_neighbours, VisibilityMatrix::from_rows({{1}, {0}}, 2));
  EXPECT_EQ(rows.source.tree, before.source.tree);
  EXPECT_FALSE(rows.source.row_tree);
  EXPECT_EQ(rows.guarantee, Guarantee::unknown);  // it was aggressive, and now invents too
  EXPECT_EQ(columns.matrix, VisibilityMatrix::from_rows({{0}, {}, {0, 1}}, 2));
  EXPECT_EQ(columns.source.tree->object_of_node()[4], 0u);
  EXPECT_EQ(columns.source.row_tree, before.source.row_tree);
  EXPECT_TRUE(is_monotone(over_nodes(columns).matrix, *columns.source.tree));
  EXPECT_FALSE(merged(over_nodes(before), {}, Partition::from_group_of_member({0, 1, 1, 2, 3})).source.tree);
  EXPECT_TRUE(merged(over_nodes(before), pair, {}).source.tree);
}

// Whatever was done in whatever order, the groups lead from the source's numbers.
TEST(Dataset, GroupsLeadFromTheSourcesNumbers) {
  const Dataset source = full_dataset();
  const auto turn = Permutation::from_new_of_old({2, 0, 1}), swap = Permutation::from_new_of_old({1, 0});
  const auto pair = Partition::from_group_of_member({0, 1, 1}),
             other = Partition::from_group_of_member({1, 0, 0});
  Dataset lossy = reordered(merged(reordered(source, turn, turn), pair, other), swap, swap);
  EXPECT_FALSE(lossy.source.row_order || lossy.source.column_order);
  const VisibilityMatrix back = in_source_numbers(lossy).matrix;
  EXPECT_EQ(back, VisibilityMatrix::from_rows({{0, 1, 2}, {}, {0, 1, 2}}, 3));
  lossy = merged(lossy, Partition::from_group_of_member({0, 0}), {});
  EXPECT_EQ(lossy.source.row_groups, Partition::from_group_of_member({0, 0, 0}));
  EXPECT_EQ(in_source_numbers(reordered(source, turn, turn)).matrix, source.matrix);
}

TEST(Dataset, KeepsEverythingInBinsparse) {
  const TemporaryFolder folder;
  const auto turned = reordered(full_dataset(), Permutation::from_new_of_old({2, 0, 1}),
                                Permutation::from_new_of_old({1, 0, 2}));
  const auto groups = merged(full_dataset(), Partition::from_group_of_member({0, 1, 0}),
                             Partition::from_group_of_member({1, 0, 0}));
  for (const Dataset& dataset : {Dataset{}, full_dataset(), over_nodes(full_dataset()), large_dataset(),
                                 turned, groups, differences()}) {
    write_dataset(folder / "a.bsp.h5", dataset);
    EXPECT_EQ(read_dataset(folder / "a.bsp.h5"), dataset);
  }
  EXPECT_EQ(folder.entries(), 1u);
}

TEST(Dataset, KeepsMatrixAndFactsInMatrixMarket) {
  const TemporaryFolder folder;
  write_dataset(folder / "a.mtx", full_dataset());
  Dataset expected = full_dataset();
  expected.row_bounds = expected.column_bounds = {};
  expected.row_neighbours = std::nullopt;
  expected.source = {};
  expected.sight_lines = {};
  expected.degree_of_visibility = {};
  EXPECT_EQ(read_dataset(folder / "a.mtx"), expected);
}

TEST(Dataset, IsToldByItsFirstBytes) {
  const TemporaryFolder folder;
  write_dataset(folder / "a.mtx", full_dataset());
  write_dataset(folder / "b.h5", full_dataset());
  std::filesystem::rename(folder / "a.mtx", folder / "c.h5");
  std::filesystem::rename(folder / "b.h5", folder / "c.mtx");
  EXPECT_EQ(read_dataset(folder / "c.h5").matrix, full_dataset().matrix);
  EXPECT_EQ(read_dataset(folder / "c.mtx"), full_dataset());
  std::ofstream(folder / "d.mtx") << "3 4 5\n";
  EXPECT_NE(reading_refusal(folder / "d.mtx").find("d.mtx: is no matrix file; a matrix is read from"),
            std::string::npos);
  EXPECT_NE(reading_refusal(folder / "e").find("No such file"), std::string::npos);
  EXPECT_THROW(write_dataset(folder / "a.txt", Dataset{}), std::invalid_argument);
}

TEST(Dataset, OverNodesUnitesWhatIsBelow) {
  const Dataset nodes = over_nodes(full_dataset());
  EXPECT_EQ(nodes.matrix, VisibilityMatrix::from_rows({{0, 1, 2, 4}, {}, {0, 2, 3, 4}}, 5));
  EXPECT_TRUE(nodes.source.columns_are_nodes);
  EXPECT_EQ(nodes.column_bounds[2], (Box{{5, 5, 5}, {9, 9, 9}}));
  EXPECT_EQ(nodes.column_bounds[0], (Box{{0, 0, 0}, {9, 9, 9}}));
}

TEST(Dataset, SameDatasetSameBytes) {
  const TemporaryFolder folder;
  for (const char* ending : {".h5", ".mtx"}) {
    const auto first = folder / (std::string("a") + ending), second = folder / (std::string("b") + ending);
    write_dataset(first, full_dataset());
    write_dataset(second, full_dataset());
    EXPECT_EQ(read_file(first), read_file(second));
  }
}

TEST(Dataset, RefusesGeometryThatDoesNotFit) {
  const TemporaryFolder folder;
  const auto refused = [&](const std::string& words, const std::function<void(Dataset&)>& slip) {
    Dataset dataset = full_dataset();
    slip(dataset);
    Hdf5File file = Hdf5File::create(folder / "a.h5");  // unchecked
    write_binsparse(file, dataset);
    file.close();
    const std::string text = reading_refusal(folder / "a.h5");
    EXPECT_NE(text.find(words), std::string::npos) << text;
    EXPECT_EQ(text.find('\n'), std::string::npos);
  };
  refused("/vismat/row_bounds: box 2 is not finite", [](Dataset& d) { d.row_bounds[2].high[1] = NAN; });
  refused("/vismat/column_bounds: box 0", [](Dataset& d) { d.column_bounds[0].low[2] = 4; });
  refused("/vismat/row_neighbours/pointers_to_1: has 2 entries", [](Dataset& d) {
    d.row_neighbours = VisibilityMatrix({1, 1});
  });
  refused("/vismat/tree: has 0 objects, but there are 3 columns",
          [](Dataset& d) { d.source.tree = ObjectTree(); });
  refused("/vismat/tree: has 5 nodes, but there are 3 columns",
          [](Dataset& d) { d.source.columns_are_nodes = true; });
  refused("sees a node of /vismat/tree but not its parent", [](Dataset& d) {
    d = over_nodes(d);
    d.matrix = VisibilityMatrix::from_rows({{4}, {}, {}}, 5);
  });
  refused("/vismat/tree: is missing", [](Dataset& d) {
    d.source.columns_are_nodes = true;
    d.source.tree = std::nullopt;
  });
  refused("/vismat/row_names: has 2 names, but there are 3 rows",
          [](Dataset& d) { d.source.row_names.pop_back(); });
  refused("/vismat/column_levels: has 1 columns, but there are 3 columns of the source",
          [](Dataset& d) { d.source.column_levels.resize(1); });
  refused("/vismat/row_tree: has 4 objects, but there are 3 rows",
          [](Dataset& d) { d.source.row_tree = ObjectTree::from_parents({ObjectTree::none}, {0}, 4); });
  Dataset misfit = full_dataset();
  misfit.source.row_names.pop_back();
  EXPECT_THROW(write_dataset(folder / "b.h5", misfit), std::invalid_argument);
  EXPECT_EQ(folder.entries(), 1u);
  refused("/vismat/boundaries: must have dimensions [lists / 2, 2], but there are 3 lists", [](Dataset& d) {
    d.source.boundaries = {{Boundary::outside, 0}};
  });
  refused("/vismat/boundaries: must have dimensions [lists / 2, 2], but there are 8 lists", [](Dataset& d) {
    d = differences();
    d.source.boundaries.pop_back();
  });
  refused("/vismat/boundaries: boundary 3, cell 3 to cell 1: leads down", [](Dataset& d) {
    d = differences();
    std::swap(d.source.boundaries[3].from, d.source.boundaries[3].to);
  });
  refused("/vismat/boundaries: boundary 1, outside to cell 3: must enter that part at its least",
          [](Dataset& d) {
            d = differences();
            d.source.boundaries[0].to = 2;
            d.source.boundaries[1].to = 3;
          });
}

TEST(Dataset, EveryTruncationIsRefused) {
  const TemporaryFolder folder;
  write_dataset(folder / "a.h5", full_dataset());
  write_dataset(folder / "b.h5", large_dataset());
  for (const char* name : {"a.h5", "b.h5"}) {
    const auto bytes = read_file(folder / name);
    ASSERT_EQ(reading_refusal(folder / name), "");
    const std::size_t step = bytes.size() / 150;
    for (std::size_t keep = 0; keep < bytes.size(); keep += step) {
      write_file(folder / "cut.h5", std::span(bytes).first(keep));
      EXPECT_NE(reading_refusal(folder / "cut.h5"), "") << keep << " of " << bytes.size();
    }
  }
}

// The program: exit status, what it printed on stderr, and whether OUT came to be.
struct Outcome {
  int status;
  std::string errors;
};
Outcome run_convert(const std::filesystem::path& in, const std::filesystem::path& out) {
  const std::string command = std::string(VISMAT_PROGRAM) + " convert '" + in.string() + "' -o '" +
                              out.string() + "' 2>&1 >/dev/null";
  std::FILE* pipe = ::popen(command.c_str(), "r");
  Outcome run;
  for (int c; (c = std::fgetc(pipe)) != EOF;) run.errors += static_cast<char>(c);
  run.status = WEXITSTATUS(::pclose(pipe));
  return run;
}

TEST(Convert, ConvertsBothWays) {
  const TemporaryFolder folder;
  write_dataset(folder / "a.bsp.h5", full_dataset());
  EXPECT_EQ(run_convert(folder / "a.bsp.h5", folder / "b.mtx").status, 0);
  EXPECT_EQ(run_convert(folder / "b.mtx", folder / "c.bsp.h5").status, 0);
  EXPECT_EQ(read_dataset(folder / "c.bsp.h5"), read_dataset(folder / "b.mtx"));
  EXPECT_EQ(read_dataset(folder / "c.bsp.h5").matrix, full_dataset().matrix);
}

TEST(Convert, BadFilesGiveOneLineAndNoOutput) {
  const TemporaryFolder folder;
  write_dataset(folder / "good.h5", large_dataset());
  const auto good = read_file(folder / "good.h5");
  std::vector<std::filesystem::path> bad;
  for (const std::size_t keep :
       {std::size_t{7}, std::size_t{100}, std::size_t{900}, good.size() / 2, good.size() - 1}) {
    bad.push_back(folder / ("cut" + std::to_string(keep) + ".h5"));
    write_file(bad.back(), std::span(good).first(keep));
  }
  Random random(11);  // scattered damage, which the library itself may not survive
  for (int i = 0; i < 20; ++i) {
    auto bytes = good;
    for (int k = 0; k < 200; ++k) {
      bytes[random.below(2048)] = static_cast<std::byte>(random.below(256));
    }
    std::memcpy(bytes.data(), good.data(), 8);
    bad.push_back(folder / ("damaged" + std::to_string(i) + ".h5"));
    write_file(bad.back(), bytes);
  }
  std::ofstream(folder / "short.mtx") << "%%MatrixMarket matrix coordinate pattern general\n3 4 5\n1 1\n";
  bad.push_back(folder / "short.mtx");
  bad.push_back(folder / "missing");
  const std::size_t entries = folder.entries();
  for (const auto& path : bad) {
    const Outcome run = run_convert(path, folder / "out.mtx");
    EXPECT_EQ(run.status, 1) << path;
    EXPECT_EQ(std::count(run.errors.begin(), run.errors.end(), '\n'), 1) << run.errors;
    EXPECT_EQ(run.errors.find("vismat: " + path.string() + ": "), 0u) << run.errors;
    EXPECT_EQ(folder.entries(), entries);
  }
  const Outcome run = run_convert(folder / "good.h5", folder / "nowhere/out.mtx");
  EXPECT_EQ(run.status, 1);
  EXPECT_NE(run.errors.find("nowhere/out.mtx"), std::string::npos);
}

}  // namespace
}  // namespace vismat
