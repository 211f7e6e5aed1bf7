// Files read row by row: every codec that can, every form, damage at every byte, threads, memory.
#include "codecs/row_reader.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <thread>

#include "codecs/baseline_codecs.h"
#include "codecs/bitmap.h"
#include "matrix/checksum.h"
#include "codecs/container.h"
#include "matrix/atomic_file.h"
#include "matrix/deltas.h"
#include "tests/codecs/matrices.h"
#include "tests/matrix/temporary_folder.h"

namespace vismat {
namespace {

std::vector<Codec> row_codecs() {
  std::vector<Codec> codecs = all_codecs();
  std::erase_if(codecs, [](const Codec& c) { return c.open_rows == nullptr; });
  return codecs;
}

std::string test_name(const testing::TestParamInfo<Codec>& codec) {
  std::string name(codec.param.name);
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
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
  reader.bits(r, buffers.bits);
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
  matrices.push_back({"many rows", test::clustered_matrix({5000, 90}, 21)});    // an index of several blocks
  matrices.push_back({"long rows", test::random_matrix({9, 90000}, .01, 22)});  // rows over several blocks
  for (const auto& m : matrices) {
    const auto file = write_container(compress(m.matrix, GetParam()));
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
  const auto file = write_container(compress(matrix, GetParam()));
  const ContainerHead head(file);
  Buffers buffers;
  for (const std::uint32_t r : {0u, 200u, 399u}) {
    std::uint64_t damaged = 0;
    for (std::uint64_t b = 0; b < head.blocks(); ++b) {
      auto bad = file;
      const std::size_t at = file.size() - head.body().size() + b * ContainerHead::block_bytes;
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
    // The model, three of the index, the row's and those that share its bytes.
    EXPECT_LE(damaged, 8u + GetParam().rows_per_part * row_bytes_of(3000) / ContainerHead::block_bytes)
        << "of " << head.blocks() << " blocks";
  }
}

TEST_P(EveryRowCodec, ServesThreadsFromOneOpenFile) {
  const auto matrix = test::clustered_matrix({2000, 700}, 24);
  const auto file = write_container(compress(matrix, GetParam()));
  const RowReader reader(file, std::span(&GetParam(), 1));
  std::vector<std::thread> threads;
  std::vector<std::uint64_t> wrong(4, 0);
  for (std::uint32_t t = 0; t < 4; ++t) {
    threads.emplace_back([&, t] {
      RowBuffer<std::uint32_t> buffer;
      Random random(t);
      for (int i = 0; i < 3000; ++i) {
        const std::uint32_t r = random.below(2000);
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
  const auto good = write_container(compress(matrix, GetParam()));
  const std::size_t body = good.size() - ContainerHead(good).body().size();
  Buffers buffers;
  Random random(3);
  for (std::size_t i = body; i < good.size(); ++i) {
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

INSTANTIATE_TEST_SUITE_P(Table, EveryRowCodec, testing::ValuesIn(row_codecs()), test_name);

TEST(Container, RefusesEveryPrefixEveryFlippedBitAndMore) {
  const auto file = write_container(compress(test::clustered_matrix({24, 16}, 12), find_codec("quake-rle")));
  Buffers buffers;
  // A file is refused when it is opened, or when the damaged block is needed: all of it is.
  const auto read_all = [&](std::span<const std::byte> bytes) {
    const RowReader reader(bytes);
    reader.facts();
    reader.row_order();
    reader.column_order();
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
  auto file = write_container(compress(VisibilityMatrix(Shape{2, 2}), find_codec("bitmap")));
  for (const unsigned version : {0u, 2u, 4u, 255u}) {
    file[8] = static_cast<std::byte>(version);
    try {
      RowReader reader(file);
      FAIL();
    } catch (const FormatError& error) {
      EXPECT_NE(std::string(error.what())
                    .find("version " + std::to_string(version) + "; this program reads version 3"),
                std::string::npos)
          << error.what();
    }
  }
}

TEST(Container, RefusesBytesBehindTheCodecsName) {
  auto file = write_container(compress(VisibilityMatrix(Shape{2, 2}), find_codec("bitmap")));
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

TEST(Container, StoresOrdersInTheFewestWholeBits) {
  Container container = compress(VisibilityMatrix(Shape{1000, 5}), find_codec("bitmap"));
  const auto without = write_container(container).size();
  container.row_order = Permutation::identity(1000);
  EXPECT_EQ(write_container(container).size() - without, 1250u);  // 10 bits each
}

// Cells on a ring, and one that touches none.
Container container_of_differences() {
  const auto cells = test::clustered_matrix({20, 60}, 27);
  std::vector<std::vector<std::uint32_t>> neighbours(20);
  for (std::uint32_t c = 1; c < 20; ++c) neighbours[c] = {c == 1 ? 19 : c - 1, c == 19 ? 1 : c + 1};
  for (auto& list : neighbours) std::sort(list.begin(), list.end());
  const Deltas deltas = deltas_of(cells, VisibilityMatrix::from_rows(neighbours, 20));
  Container container = compress(deltas.lists, find_codec("delimiter"));
  container.boundaries = deltas.boundaries;
  return container;
}

TEST(RowReader, WalksThroughAFileOfDifferences) {
  const auto file = write_container(container_of_differences());
  EXPECT_EQ(read_container(file), container_of_differences());
  const RowReader reader(file);
  const auto boundaries = reader.boundaries();
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
    count = cross(std::span(visible).first(count), reader.ids(crossing.appears(), appears),
                  reader.ids(crossing.vanishes(), vanishes), next);
    visible.swap(next);
    next.resize(60);
    cell = to;
    ASSERT_TRUE(std::ranges::equal(std::span(visible).first(count), cells.row(cell))) << "step " << step;
  }
}

TEST(Container, RefusesBoundariesThatAreNone) {
  const auto refused = [](auto change) {
    Container container = container_of_differences();
    change(container.boundaries);
    const auto file = write_container(container);
    EXPECT_THROW(read_container(file), FormatError);
    EXPECT_THROW(RowReader(file).boundaries(), FormatError);
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
  container.column_order = Permutation::identity(1300);
  auto file = write_container(container);
  write_file(path, file);
  Buffers buffers;
  {
    RowReader reader(path);
    RowReader moved = std::move(reader);
    for (std::uint32_t r = 0; r < 70; ++r) expect_row(moved, r, matrix.row(r), buffers, "file");
    EXPECT_EQ(moved.facts(), container.facts);
    EXPECT_EQ(moved.column_order(), container.column_order);
    EXPECT_EQ(moved.row_order(), std::nullopt);
    EXPECT_THROW(moved.ids(70, buffers.ids), std::out_of_range);
    EXPECT_THROW(moved.bits(0, std::span(buffers.bits).first(2)), std::length_error);
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
  const auto file = write_container(compress(VisibilityMatrix(Shape{2, 2}), find_codec("gzip")));
  EXPECT_THROW(RowReader(file, all_codecs()), FormatError);
  EXPECT_THROW(RowReader{file}, FormatError);  // and none of ours
}

TEST(Checksum, IsTheOneOfZip) {
  const auto sum = [](const std::string& text) { return crc32(std::as_bytes(std::span(text))); };
  EXPECT_EQ(sum(""), 0u);
  EXPECT_EQ(sum("123456789"), 0xcbf43926u);  // the value that its definition gives
  EXPECT_EQ(sum("The quick brown fox jumps over the lazy dog"), 0x414fa339u);
}

}  // namespace
}  // namespace vismat
