// Files read row by row: every codec that can, every form, damage at every byte, threads, memory.
#include "codecs/vmat/row_reader.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <thread>

#include "codecs/baselines/baseline_codecs.h"
#include "codecs/entropy/bit_stream.h"
#include "codecs/rows/bitmap.h"
#include "codecs/vmat/container.h"
#include "codecs/vmat/sections.h"
#include "matrix/base/atomic_file.h"
#include "matrix/base/checksum.h"
#include "matrix/dataset.h"
#include "matrix/deltas.h"
#include "tests/codecs/matrices.h"
#include "tests/matrix/temporary_folder.h"
#include "tests/sanitized.h"
#include "tests/table_name.h"

namespace vismat {
namespace {

std::vector<Codec> row_codecs() {
  std::vector<Codec> codecs = all_codecs();
  std::erase_if(codecs, [](const Codec& c) { return c.open == nullptr; });
  return codecs;
}

// The matrix with a tree of pairs over its rows, for codecs that need one.
Container container_of(const VisibilityMatrix& matrix, const Codec& codec) {
  SourceMap source;
  const std::uint32_t rows = matrix.shape().rows;
  if (codec.needs.tree == TreeOver::rows)
    source.row_tree = rows == 0 ? ObjectTree{} : test::even_tree(rows, 2);
  return compress(matrix, codec, std::move(source));
}
std::vector<std::byte> file_of(const VisibilityMatrix& matrix, const Codec& codec) {
  return write_container(container_of(matrix, codec));
}

struct Buffers {
  RowBuffer<std::uint32_t> ids;
  RowBuffer<Run> runs;
  std::vector<std::uint64_t> bits;
};

void expect_row(const RowReader& reader, std::uint32_t r, std::span<const std::uint32_t> truth,
                Buffers& buffers, const std::string& name) {
  EXPECT_TRUE(std::ranges::equal(reader.ids(r, buffers.ids), truth)) << name << ", row " << r;

  std::vector<std::uint32_t> ids;
  std::uint64_t last_end = 0;
  for (const Run run : reader.runs(r, buffers.runs)) {
    EXPECT_TRUE(ids.empty() || run.first > last_end) << name << ": adjacent runs, row " << r;
    last_end = std::uint64_t{run.first} + run.count;
    for (std::uint32_t i = 0; i < run.count; ++i) ids.push_back(run.first + i);
  }
  EXPECT_TRUE(std::ranges::equal(ids, truth)) << name << ", row " << r;

  buffers.bits.assign((reader.shape().columns + 63) / 64, 0xdead);
  reader.bits(r, buffers.bits, buffers.ids);
  ids.clear();
  for (std::size_t w = 0; w < buffers.bits.size(); ++w) {
    for (std::uint64_t word = buffers.bits[w]; word != 0; word &= word - 1)
      ids.push_back(static_cast<std::uint32_t>(w * 64) + static_cast<std::uint32_t>(std::countr_zero(word)));
  }
  EXPECT_TRUE(std::ranges::equal(ids, truth)) << name << ", row " << r;
}

class EveryRowCodec : public testing::TestWithParam<Codec> {};

TEST_P(EveryRowCodec, ReadsEachRowAloneInEveryForm) {
  Buffers buffers;
  auto matrices = test::assorted_matrices();
  const std::uint32_t many = test::sanitized ? 1500 : 3000;
  matrices.push_back({"many rows", test::clustered_matrix({many, 90}, 21)});    // an index of several blocks
  matrices.push_back({"long rows", test::random_matrix({9, 60000}, .01, 22)});  // rows over several blocks
  for (const auto& m : matrices) {
    const auto file = file_of(m.matrix, GetParam());
    const RowReader reader(file, std::span(&GetParam(), 1));
    EXPECT_EQ(reader.shape(), m.matrix.shape());
    EXPECT_EQ(reader.ones(), m.matrix.ones());
    EXPECT_EQ(reader.codec(), GetParam().name);
    // Backwards: no row may depend on what was read before.
    for (std::uint32_t r = m.matrix.shape().rows; r-- > 0;)
      expect_row(reader, r, m.matrix.row(r), buffers, m.name);
  }
}

// Blocks that a row does not need are overwritten, and so would be refused.
TEST_P(EveryRowCodec, TouchesNoOtherBlock) {
  const auto matrix = test::random_matrix({400, 3000}, .1, 23);
  const auto file = file_of(matrix, GetParam());
  const ContainerHead head(file);
  Buffers buffers;
  for (const std::uint32_t r : test::sanitized ? std::vector{200u} : std::vector{0u, 200u, 399u}) {
    std::uint64_t damaged = 0;
    const std::uint64_t blocks = CheckedBytes::blocks_of(head.body().size());
    for (std::uint64_t b = 0; b < blocks; ++b) {
      auto bad = file;
      const std::size_t at = file.size() - head.body().size() + b * CheckedBytes::block_bytes;
      bad[at] ^= std::byte{1};
      try {
        const RowReader reader(bad, std::span(&GetParam(), 1));
        expect_row(reader, r, matrix.row(r), buffers, "damaged elsewhere");
      } catch (const FormatError& error) {
        EXPECT_NE(std::string(error.what()).find("checksum"), std::string::npos) << error.what();
        ++damaged;
      }
    }
    EXPECT_GE(damaged, 1u);
    // The tree, the model, three of the index, the row's and those that share its bytes; down a tree two a part.
    const std::uint64_t of_parts =
        GetParam().needs.tree == TreeOver::rows
            ? 2 * RowReader(file, std::span(&GetParam(), 1)).cost(r).parts
            : GetParam().rows_per_part * row_bytes_of(3000) / CheckedBytes::block_bytes;
    EXPECT_LE(damaged, 8u + of_parts) << "of " << blocks << " blocks";
  }
}

TEST_P(EveryRowCodec, ServesThreadsFromOneOpenFile) {
  constexpr std::uint32_t rows = 400;
  const auto matrix = test::clustered_matrix({rows, 300}, 24);
  const auto file = file_of(matrix, GetParam());
  const RowReader reader(file, std::span(&GetParam(), 1));
  std::vector<std::thread> threads;
  std::vector<std::uint64_t> wrong(4, 0);
  for (std::uint32_t t = 0; t < 4; ++t) {
    threads.emplace_back([&, t] {
      RowBuffer<std::uint32_t> buffer;
      Random random(t);
      for (int i = 0; i < test::trials(1500); ++i) {
        const std::uint32_t r = random.below(rows);
        wrong[t] += !std::ranges::equal(reader.ids(r, buffer), matrix.row(r));
      }
    });
  }
  for (auto& thread : threads) thread.join();
  EXPECT_EQ(wrong, std::vector<std::uint64_t>(4, 0));
}

// Checksums made right, contents wrong: a row is refused or is some row, and nothing else happens.
TEST_P(EveryRowCodec, SurvivesDamageThatChecksumsDoNotSee) {
  const auto matrix = test::clustered_matrix({60, 200}, 25);
  const auto good = file_of(matrix, GetParam());
  const std::size_t body = good.size() - ContainerHead(good).body().size();
  Buffers buffers;
  Random random(3);
  for (std::size_t i = body; i < good.size(); i += test::sanitized ? 5 : 1) {
    auto bad = good;
    bad[i] ^= static_cast<std::byte>(1 + random.below(255));
    seal_container(bad);
    try {
      const RowReader reader(bad, std::span(&GetParam(), 1));
      for (std::uint32_t r = 0; r < 60; ++r) {
        try {
          for (const std::uint32_t id : reader.ids(r, buffers.ids)) ASSERT_LT(id, 200u);
        } catch (const FormatError&) {
        }
      }
    } catch (const FormatError&) {
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Table, EveryRowCodec, testing::ValuesIn(row_codecs()), test::table_name);

TEST(Container, RefusesEveryPrefixEveryFlippedBitAndMore) {
  const auto file = file_of(test::clustered_matrix({24, 16}, 12), find_codec("quake-rle"));
  Buffers buffers;
  // A file is refused when it is opened, or when the damaged block is needed: all of it is.
  const auto read_all = [&](std::span<const std::byte> bytes) {
    const RowReader reader(bytes);
    reader.facts();
    reader.source();
    for (std::uint32_t r = 0; r < reader.shape().rows; ++r) reader.ids(r, buffers.ids);
  };
  read_all(file);
  for (std::size_t n = 0; n < file.size(); ++n) {
    EXPECT_THROW(read_container(std::span(file).first(n)), FormatError) << n;
    EXPECT_THROW(RowReader(std::span(file).first(n)), FormatError) << n;
  }
  for (std::size_t bit = 0; bit < file.size() * 8; ++bit) {
    auto bad = file;
    bad[bit / 8] ^= std::byte{1} << (bit % 8);
    EXPECT_THROW(read_container(bad), FormatError) << "bit " << bit;
    EXPECT_THROW(read_all(bad), FormatError) << "bit " << bit;
  }
  auto longer = file;
  longer.push_back(std::byte{0});
  EXPECT_THROW(read_container(longer), FormatError);
}

TEST(Container, RefusesForeignVersionsByTheirNumber) {
  auto file = file_of(VisibilityMatrix(Shape{2, 2}), find_codec("bitmap"));
  for (const unsigned version : {0u, 2u, 3u, 255u}) {
    file[8] = static_cast<std::byte>(version);
    try {
      RowReader reader(file);
      FAIL();
    } catch (const FormatError& error) {
      EXPECT_NE(std::string(error.what())
                    .find("version " + std::to_string(version) + "; this program reads version 4"),
                std::string::npos)
          << error.what();
    }
  }
}

TEST(Container, RefusesBytesBehindTheCodecsName) {
  auto file = file_of(VisibilityMatrix(Shape{2, 2}), find_codec("bitmap"));
  file[28 + 31] = std::byte{'x'};
  seal_container(file);
  EXPECT_THROW(read_container(file), FormatError);
}

TEST(Container, ChecksTheNumberOfOnes) {
  Container container = compress(VisibilityMatrix::from_rows({{0}, {1}}, 2), find_codec("bitmap"));
  for (const std::uint64_t ones : {0, 1, 3}) {
    container.ones = ones;
    EXPECT_THROW(decompress(container, find_codec("bitmap")), FormatError) << ones;
  }
}

// What a hostile file makes a reader hold is bounded by what it states: here three ones.
TEST(Container, TakesNoMoreMemoryThanItStates) {
  Container container = compress(test::random_matrix({3, 1u << 20}, 2, 1), find_codec("bitmap"));
  container.ones = 3;
  EXPECT_THROW(decompress(container, find_codec("bitmap")), FormatError);
  const auto file = write_container(container);
  const RowReader reader(file);
  RowBuffer<std::uint32_t> ids;
  EXPECT_THROW(reader.ids(0, ids), FormatError);
  EXPECT_EQ(ids.content().size(), 0u);
}

// Cells on a ring, and one that touches none.
Container container_of_differences() {
  const auto cells = test::clustered_matrix({20, 60}, 27);
  std::vector<std::vector<std::uint32_t>> neighbours(20);
  for (std::uint32_t c = 1; c < 20; ++c) neighbours[c] = {c == 1 ? 19 : c - 1, c == 19 ? 1 : c + 1};
  for (auto& list : neighbours) std::sort(list.begin(), list.end());
  const Deltas deltas = deltas_of(cells, VisibilityMatrix::from_rows(neighbours, 20));
  Container container = compress(deltas.lists, find_codec("delimiter"));
  container.source.boundaries = deltas.boundaries;
  return container;
}

void walks_through(const Container& container) {
  const auto file = write_container(container);
  EXPECT_EQ(read_container(file), container);
  const RowReader reader(file);
  const auto& rows = reader.source().list_rows;
  const auto row_of = [&](std::uint32_t list) { return rows ? rows->group_of_member()[list] : list; };
  const auto boundaries = reader.source().boundaries;
  ASSERT_EQ(boundaries.size(), 21u);
  const BoundaryMap map(boundaries);
  const auto cells = test::clustered_matrix({20, 60}, 27);
  RowBuffer<std::uint32_t> appears, vanishes;
  std::vector<std::uint32_t> visible(60), next(60);
  std::size_t count = 0;
  std::uint32_t cell = Boundary::outside;
  for (std::uint32_t step = 1; step < 60; ++step) {
    const std::uint32_t to = 1 + (step - 1) % 19;
    const Crossing crossing = map.crossing(cell, to).value();
    count = cross(std::span(visible).first(count), reader.ids(row_of(crossing.appears()), appears),
                  reader.ids(row_of(crossing.vanishes()), vanishes), next);
    visible.swap(next);
    next.resize(60);
    cell = to;
    ASSERT_TRUE(std::ranges::equal(std::span(visible).first(count), cells.row(cell))) << "step " << step;
  }
}

TEST(RowReader, WalksThroughAFileOfDifferences) {
  const Container container = container_of_differences();
  walks_through(container);
  // Equal lists once, in an order of their own.
  Dataset data;
  data.matrix = decompress(container, find_codec("delimiter"));
  data.source = container.source;
  const Partition equal = equal_rows(data.matrix);
  data = merged(std::move(data), equal, std::nullopt);
  EXPECT_LT(data.matrix.shape().rows, container.shape.rows);
  const Container moved =
      compress(data.matrix, find_codec("rows-small"), data.source, {.rows_may_move = true});
  ASSERT_TRUE(moved.source.list_rows);
  walks_through(moved);
}

TEST(Container, RefusesListsThatNoRowHolds) {
  Container container = container_of_differences();
  std::vector<std::uint32_t> rows(container.shape.rows);
  container.source.list_rows = Partition::from_group_of_member(rows);
  EXPECT_THROW(write_container(container), std::invalid_argument);  // fewer rows than the matrix has
  container.source = {};
  container.source.list_rows = Partition::identity(container.shape.rows);
  EXPECT_THROW(write_container(container), std::invalid_argument);  // without boundaries
}

TEST(Container, RefusesBoundariesThatAreNone) {
  const auto refused = [](auto change) {
    Container container = container_of_differences();
    change(container.source.boundaries);
    EXPECT_THROW(write_container(container), std::invalid_argument);
    EXPECT_THROW(boundaries_from_bytes(boundary_bytes(container.source.boundaries), container.shape.rows),
                 FormatError);
  };
  refused([](auto& b) { b.pop_back(); });                 // fewer than half the rows
  refused([](auto& b) { b.back() = b[b.size() - 2]; });   // the same twice
  refused([](auto& b) { b.back().to = 0xfffffffe; });     // a cell among 2^32 that nothing else reaches
  refused([](auto& b) { b.back().to = b.back().from; });  // a cell and itself
}

TEST(RowReader, ReadsAFileAndNamesItWhereItIsDamaged) {
  const TemporaryFolder folder;
  const auto path = folder / "matrix.vmat";
  const auto matrix = test::random_matrix({70, 1300}, .3, 26);  // several blocks
  Container container = compress(matrix, find_codec("quake-rle"));
  container.facts = "guarantee: exact\n";
  container.source.column_order = Permutation::identity(1300);
  auto file = write_container(container);
  write_file(path, file);
  Buffers buffers;
  {
    RowReader reader(path);
    RowReader moved = std::move(reader);
    for (std::uint32_t r = 0; r < 70; ++r) expect_row(moved, r, matrix.row(r), buffers, "file");
    EXPECT_EQ(moved.facts(), container.facts);
    EXPECT_EQ(moved.source(), container.source);
    EXPECT_THROW(moved.ids(70, buffers.ids), std::out_of_range);
    EXPECT_THROW(moved.bits(0, std::span(buffers.bits).first(2), buffers.ids), std::length_error);
    EXPECT_THROW(moved.cost(70), std::out_of_range);
  }
  file.back() ^= std::byte{1};
  write_file(path, file);
  try {
    RowReader(path).ids(69, buffers.ids);
    FAIL();
  } catch (const FormatError& error) {
    EXPECT_NE(std::string(error.what()).find(path.string() + ": row 69: "), std::string::npos)
        << error.what();
  }
  EXPECT_THROW(RowReader(folder / "none.vmat"), std::runtime_error);
  write_file(path, {});
  EXPECT_THROW(RowReader{path}, FormatError);
}

TEST(RowReader, RefusesCodecsThatGiveNoRows) {
  const auto file = file_of(VisibilityMatrix(Shape{2, 2}), find_codec("gzip"));
  EXPECT_THROW(RowReader(file, all_codecs()), FormatError);
  EXPECT_THROW(RowReader{file}, FormatError);  // and none of ours
}

// One buffer goes from file to file and from codec to codec: what one reader left in it is not taken for another's.
TEST(RowReader, BuffersServeEveryReader) {
  std::vector<VisibilityMatrix> matrices;
  for (std::uint64_t seed = 40; seed < 43; ++seed)
    matrices.push_back(test::clustered_matrix({64, 200}, seed));
  std::vector<std::pair<RowReader, const VisibilityMatrix*>> readers;
  std::vector<std::vector<std::byte>> files;
  for (const Codec& codec : row_codecs()) {
    for (const VisibilityMatrix& matrix : matrices) files.push_back(file_of(matrix, codec));
  }
  for (std::size_t f = 0; f < files.size(); ++f)
    readers.emplace_back(RowReader(files[f], all_codecs()), &matrices[f % 3]);
  Buffers buffers;
  Random random(5);
  for (int i = 0; i < 4000; ++i) {
    const auto& [reader, matrix] = readers[random.below(static_cast<std::uint32_t>(readers.size()))];
    const std::uint32_t row = random.below(64);
    expect_row(reader, row, matrix->row(row), buffers, std::string(reader.codec()));
  }
}

// After a part that is damaged the buffer serves the next row all the same.
TEST(RowReader, DamageLeavesNothingInTheBuffer) {
  const auto matrix = test::random_matrix({100, 3000}, .1, 44);
  for (const Codec& codec : row_codecs()) {
    auto file = file_of(matrix, codec);
    file[file.size() - 1] ^= std::byte{1};  // the last block
    const RowReader reader(file, std::span(&codec, 1));
    Buffers buffers;
    std::size_t refused = 0;
    for (std::uint32_t step = 0; step < 100; ++step) {
      const std::uint32_t row = step % 2 == 0 ? 99 - step : step;
      try {
        expect_row(reader, row, matrix.row(row), buffers, std::string(codec.name));
      } catch (const FormatError&) {
        ++refused;
      }
    }
    EXPECT_GT(refused, 0u) << codec.name;
    EXPECT_LT(refused, 100u) << codec.name;
  }
}

// A root that is damaged leaves a mark on no other file's rows.
TEST(RowReader, ADamagedRootLeavesNothingInTheBuffer) {
  const auto without_a_column =
      VisibilityMatrix::from_rows(std::vector<std::vector<std::uint32_t>>(9, {0, 2}), 4);
  const auto with_all = test::random_matrix({9, 40}, .9, 47);
  for (const Codec& codec : row_codecs()) {
    if (codec.needs.tree != TreeOver::rows) continue;
    Container container = container_of(without_a_column, codec);
    container.encoded.payload[Parts(container.encoded).model().size()] ^= std::byte{0xff};
    const auto damaged = write_container(container), good = file_of(with_all, codec);
    const RowReader bad(damaged, std::span(&codec, 1)), reader(good, std::span(&codec, 1));
    Buffers buffers;
    EXPECT_THROW(bad.ids(0, buffers.ids), FormatError) << codec.name;
    for (std::uint32_t r = 0; r < 9; ++r)
      expect_row(reader, r, with_all.row(r), buffers, std::string(codec.name));
  }
}

TEST(RowReader, ABufferThatIsMovedFromServesAgain) {
  const auto matrix = test::clustered_matrix({30, 90}, 46);
  for (const Codec& codec : row_codecs()) {
    const auto file = file_of(matrix, codec);
    const RowReader reader(file, std::span(&codec, 1));
    RowBuffer<std::uint32_t> first;
    reader.ids(3, first);
    RowBuffer<std::uint32_t> second(std::move(first));
    EXPECT_TRUE(std::ranges::equal(second.content(), matrix.row(3)));
    EXPECT_TRUE(std::ranges::equal(reader.ids(4, first), matrix.row(4)));
    first = std::move(second);
    EXPECT_TRUE(std::ranges::equal(reader.ids(5, second), matrix.row(5)));
  }
}

TEST(RowReader, OutlivesTheTableThatItWasGiven) {
  const auto matrix = test::clustered_matrix({30, 90}, 45);
  const auto file = file_of(matrix, find_codec("gotsman3"));
  const RowReader reader(file, all_codecs());  // a temporary
  std::vector<Codec> other(100, find_codec("bitmap"));
  Buffers buffers;
  EXPECT_EQ(reader.codec(), "gotsman3");
  for (std::uint32_t r = 0; r < 30; ++r) expect_row(reader, r, matrix.row(r), buffers, "temporary table");
}

// As many bytes as a file claims of rows that no byte stands for.
TEST(Container, TakesNoMemoryForClaims) {
  Container container = compress(VisibilityMatrix(Shape{2, 0}), find_codec("bitmap"));
  container.shape = {1u << 28, 1};
  container.ones = 1u << 22;
  container.encoded.index.clear();
  put_varint(container.encoded.index, 1u << 28);
  EXPECT_THROW(decompress(container, find_codec("bitmap")), FormatError);
  for (const char* codec : {"zach0", "gotsman1"}) {
    Container tree = compress(VisibilityMatrix(Shape{1, 1}), find_codec("bitmap"));
    tree.codec = codec;
    (find_codec(codec).needs.tree == TreeOver::rows ? tree.source.row_tree : tree.source.tree) =
        test::even_tree(1, 2);
    tree.source.columns_are_nodes = true;
    tree.shape = find_codec(codec).needs.tree == TreeOver::rows ? Shape{1, 1u << 31} : Shape{1u << 31, 1};
    tree.ones = 1u << 31;
    tree.encoded.payload = {std::byte{1}};
    tree.encoded.index = part_index_bytes({}, 1);
    EXPECT_THROW(decompress(tree, find_codec(codec)), FormatError) << codec;
  }
}

TEST(Container, StoresOneOrderOfBothSidesOnce) {
  const std::uint32_t n = 1000;
  Container container = compress(VisibilityMatrix(Shape{n, n}), find_codec("bitmap"));
  Random random(6);
  std::vector<std::uint32_t> map(n);
  for (std::uint32_t i = 0; i < n; ++i) {
    map[i] = i;
    std::swap(map[i], map[random.below(i + 1)]);
  }
  container.source.row_order = Permutation::from_new_of_old(map);
  const auto one = write_container(container).size();
  container.source.column_order = container.source.row_order;
  const auto file = write_container(container);
  EXPECT_EQ(file.size(), one);
  EXPECT_EQ(read_container(file), container);
  EXPECT_EQ(RowReader(file).source(), container.source);
}

TEST(Checksum, IsTheOneOfZip) {
  const auto sum = [](const std::string& text) { return crc32(std::as_bytes(std::span(text))); };
  EXPECT_EQ(sum(""), 0u);
  EXPECT_EQ(sum("123456789"), 0xcbf43926u);  // the value that its definition gives
  EXPECT_EQ(sum("The quick brown fox jumps over the lazy dog"), 0x414fa339u);
}

}  // namespace
}  // namespace vismat
