#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cstring>
#include <fstream>
#include <map>
#include <numeric>
#include <stdexcept>
#include <string>
#include <vector>

#include "matrix/base/byte_reader.h"
#include "matrix/base/parallel.h"
#include "matrix/base/random.h"
#include "matrix/bit_rows.h"
#include "matrix/object_tree.h"
#include "matrix/permutation.h"
#include "matrix/visibility_matrix.h"
#include "tests/refusal.h"
#include "tests/sanitized.h"

namespace vismat {
namespace {

using Rows = std::vector<std::vector<std::uint32_t>>;

VisibilityMatrix random_matrix(Shape shape, float density, std::uint64_t seed) {
  Random random(seed);
  Rows rows(shape.rows);
  for (auto& row : rows) {
    for (std::uint32_t c = 0; c < shape.columns; ++c) {
      if (random.unit() < density) row.push_back(c);
    }
  }
  return VisibilityMatrix::from_rows(rows, shape.columns);
}

Permutation shuffled(std::uint32_t size, std::uint64_t seed) {
  std::vector<std::uint32_t> map(size);
  std::iota(map.begin(), map.end(), 0);
  Random random(seed);
  for (std::uint32_t i = size; i > 1; --i) std::swap(map[i - 1], map[random.below(i)]);
  return Permutation::from_new_of_old(std::move(map));
}

TEST(VisibilityMatrix, KnowsItsRowsAndCounts) {
  const auto matrix = VisibilityMatrix::from_rows({{1, 4}, {}, {0, 1, 2}}, 5);
  EXPECT_EQ(matrix.shape(), (Shape{3, 5}));
  EXPECT_EQ(matrix.ones(), 5u);
  EXPECT_DOUBLE_EQ(matrix.density(), 5.0 / 15);
  EXPECT_TRUE(matrix.contains(0, 4));
  EXPECT_FALSE(matrix.contains(0, 3));
  EXPECT_FALSE(matrix.contains(1, 0));
  EXPECT_EQ(VisibilityMatrix({2, 3}).ones(), 0u);
  EXPECT_EQ(VisibilityMatrix({2, 3}).row(1).size(), 0u);
  EXPECT_EQ(VisibilityMatrix().density(), 0);
}

TEST(VisibilityMatrix, RefusesWhatIsNoMatrixAndNamesTheRow) {
  const auto from = [](std::vector<std::uint64_t> offsets, std::vector<std::uint32_t> ids) {
    return test::refusal([&] { VisibilityMatrix::from_csr({2, 3}, offsets, ids); });
  };
  EXPECT_EQ(from({0, 1, 2}, {2, 0}), "");
  EXPECT_NE(from({0, 1, 2}, {2, 3}).find("row 1"), std::string::npos);
  EXPECT_NE(from({0, 2, 2}, {1, 1}).find("row 0"), std::string::npos);
  EXPECT_NE(from({0, 2, 2}, {2, 1}).find("row 0"), std::string::npos);
  EXPECT_NE(from({0, 3, 2}, {0, 1}), "");  // an offset past the ids
  EXPECT_NE(from({1, 1, 2}, {0, 1}), "");
  EXPECT_NE(from({0, 1}, {0}), "");
  EXPECT_NE(from({0, 0, 1}, {0, 1}), "");
  EXPECT_NE(test::refusal([] {
              VisibilityMatrix::from_csr({1, 0xffffffff}, {0, 2}, {0xfffffffe, 0xffffffff});
            }),
            "");
}

TEST(VisibilityMatrix, TransposeAgreesWithLookingUpEachCell) {
  const auto matrix = random_matrix({37, 65}, 0.3f, 1), other = transpose(matrix);
  ASSERT_EQ(other.shape(), (Shape{65, 37}));
  for (std::uint32_t r = 0; r < 37; ++r) {
    for (std::uint32_t c = 0; c < 65; ++c) EXPECT_EQ(matrix.contains(r, c), other.contains(c, r));
  }
  EXPECT_EQ(transpose(other), matrix);
  EXPECT_EQ(transpose(VisibilityMatrix({0, 4})).shape(), (Shape{4, 0}));
}

TEST(VisibilityMatrix, PermuteMovesCellsWhereTheMapsSay) {
  const auto matrix = random_matrix({20, 33}, 0.4f, 2);
  const auto rows = shuffled(20, 3), columns = shuffled(33, 4);
  const auto moved = permute(matrix, rows, columns);
  for (std::uint32_t r = 0; r < 20; ++r) {
    for (std::uint32_t c = 0; c < 33; ++c) {
      EXPECT_EQ(moved.contains(rows.new_of_old()[r], columns.new_of_old()[c]), matrix.contains(r, c));
    }
  }
  EXPECT_EQ(permute(moved, rows.inverse(), columns.inverse()), matrix);
}

TEST(BitRows, AgreeWithTheMatrixAtWordBoundaries) {
  for (const std::uint32_t columns : {0u, 1u, 63u, 64u, 65u, 130u}) {
    const auto matrix = random_matrix({9, columns}, 0.5f, columns);
    const BitRows bits(matrix);
    EXPECT_EQ(bits.words_per_row(), (columns + 63) / 64);
    EXPECT_EQ(bits.ones(), matrix.ones());
    EXPECT_EQ(bits.to_matrix(), matrix);
    for (std::uint32_t r = 0; r < 9; ++r) {
      for (std::uint32_t c = 0; c < columns; ++c) EXPECT_EQ(bits.get(r, c), matrix.contains(r, c));
    }
  }
}

TEST(BitRows, HammingDistanceCountsCellsThatDiffer) {
  const auto matrix = random_matrix({2, 200}, 0.5f, 5);
  const BitRows bits(matrix);
  std::uint32_t differ = 0;
  for (std::uint32_t c = 0; c < 200; ++c) differ += matrix.contains(0, c) != matrix.contains(1, c);
  EXPECT_GT(differ, 0u);
  EXPECT_EQ(hamming_distance(bits.row(0), bits.row(1)), differ);
  EXPECT_EQ(hamming_distance(bits.row(0), bits.row(0)), 0u);
}

TEST(Permutation, RefusesMapsThatAreNoBijection) {
  EXPECT_EQ(test::refusal([] { Permutation::from_new_of_old({2, 0, 1}); }), "");
  EXPECT_NE(test::refusal([] { Permutation::from_new_of_old({0, 0, 1}); }), "");
  EXPECT_NE(test::refusal([] { Permutation::from_new_of_old({0, 3, 1}); }), "");
  EXPECT_NE(test::refusal([] { Permutation::from_old_of_new({1, 1}); }), "");
}

TEST(Permutation, DirectionsAndInverse) {
  const auto order = Permutation::from_old_of_new({2, 0, 1});  // old 2 comes first
  EXPECT_EQ(order.new_of_old()[2], 0u);
  EXPECT_EQ(order.old_of_new(), (std::vector<std::uint32_t>{2, 0, 1}));
  EXPECT_EQ(order.inverse().old_of_new(), (std::vector<std::uint32_t>{1, 2, 0}));
  EXPECT_FALSE(order.is_identity());
  EXPECT_TRUE(Permutation::identity(5).is_identity());
  EXPECT_EQ(Permutation::identity(5).inverse(), Permutation::identity(5));
}

TEST(Permutation, BytesAreLogOfFactorial) {
  EXPECT_EQ(permutation_bytes(0), 0u);
  EXPECT_EQ(permutation_bytes(1), 0u);
  EXPECT_EQ(permutation_bytes(2), 1u);
  EXPECT_EQ(permutation_bytes(5), 1u);   // 120 < 2^8
  EXPECT_EQ(permutation_bytes(6), 2u);   // 720
  EXPECT_EQ(permutation_bytes(20), 8u);  // 2.4e18 < 2^64
  EXPECT_EQ(permutation_bytes(21), 9u);
}

// Root with two inner nodes; object 1 hangs below both of them.
ObjectTree small_tree() {
  constexpr auto none = ObjectTree::none;
  return ObjectTree::from_parents({none, 0, 0, 1, 1, 2, 2}, {none, none, none, 0, 1, 1, 2}, 3);
}

TEST(ObjectTree, ListsChildrenAscending) {
  const auto tree = small_tree();
  EXPECT_EQ(tree.size(), 7u);
  EXPECT_TRUE(std::ranges::equal(tree.children(0), std::vector<std::uint32_t>{1, 2}));
  EXPECT_TRUE(std::ranges::equal(tree.children(2), std::vector<std::uint32_t>{5, 6}));
  EXPECT_TRUE(tree.children(6).empty());
  EXPECT_EQ(ObjectTree().size(), 0u);
}

TEST(ObjectTree, RefusesCyclesForwardParentsAndForeignObjects) {
  constexpr auto none = ObjectTree::none;
  const auto from = [](std::vector<std::uint32_t> parents, std::vector<std::uint32_t> objects) {
    return test::refusal([&] { ObjectTree::from_parents(parents, objects, 2); });
  };
  EXPECT_EQ(from({none, 0}, {none, 1}), "");
  EXPECT_NE(from({0, 0}, {none, 1}).find("node 0"), std::string::npos);
  EXPECT_NE(from({none, 1}, {none, 1}).find("node 1"), std::string::npos);
  EXPECT_NE(from({none, 2, 0}, {none, none, none}).find("node 1"), std::string::npos);
  EXPECT_NE(from({none, none}, {none, none}).find("node 1"), std::string::npos);
  EXPECT_NE(from({none, 0}, {none, 2}).find("node 1"), std::string::npos);
  EXPECT_NE(from({none}, {none, none}), "");
}

TEST(ObjectTree, NodesAreVisibleWhereAnObjectBelowIs) {
  const auto tree = small_tree();
  const auto nodes = nodes_from_objects(VisibilityMatrix::from_rows({{}, {0}, {1}, {0, 2}}, 3), tree);
  EXPECT_EQ(nodes, VisibilityMatrix::from_rows({{}, {0, 1, 3}, {0, 1, 2, 4, 5}, {0, 1, 2, 3, 6}}, 7));
  EXPECT_TRUE(is_monotone(nodes, tree));
  EXPECT_FALSE(is_monotone(VisibilityMatrix::from_rows({{0, 3}}, 7), tree));
  EXPECT_FALSE(is_monotone(VisibilityMatrix::from_rows({{}, {1}}, 7), tree));
}

TEST(ByteReader, ReadsForwardAndRefusesToLeaveTheBytes) {
  const std::vector<std::byte> bytes = {std::byte{1}, std::byte{2}, std::byte{0xac}, std::byte{2},
                                        std::byte{9}};
  ByteReader reader(bytes, "lump 3");
  EXPECT_EQ(reader.number<std::uint16_t>(), 0x0201);
  EXPECT_EQ(reader.varint(), 300u);
  EXPECT_EQ(reader.left(), 1u);
  EXPECT_THROW(reader.number<std::uint16_t>(), FormatError);
  const std::string message = test::refusal([&] { ByteReader(bytes, "lump 3").skip(std::size_t{0} - 1); });
  EXPECT_NE(message.find("lump 3"), std::string::npos);
}

TEST(ByteReader, VarintsEndAt64Bits) {
  const auto read = [](std::vector<std::uint8_t> raw) {
    ByteReader reader(std::as_bytes(std::span(raw)), "varint");
    return reader.varint();
  };
  EXPECT_EQ(read({0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0x01}), ~std::uint64_t{0});
  EXPECT_THROW(read({0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0x02}), FormatError);
  EXPECT_THROW(read({0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0x00}), FormatError);
  EXPECT_THROW(read({0x80}), FormatError);
}

TEST(Parallel, DoesEachItemOnceOnAnyNumberOfThreads) {
  for (const unsigned threads : {0u, 1u, 2u, 7u}) {
    std::vector<std::atomic<int>> done(1000);
    parallel_for(done.size(), threads, [&](std::uint64_t i) { ++done[i]; });
    EXPECT_TRUE(std::all_of(done.begin(), done.end(), [](const auto& times) { return times == 1; }));
  }
  parallel_for(0, 2, [](std::uint64_t) { FAIL(); });
}

TEST(Parallel, GoesOnWhereTheSystemGivesNoMoreThreads) {
  if (test::sanitized) GTEST_SKIP() << "no limit of memory beside shadow memory";
  const pid_t child = ::fork();
  if (child == 0) {  // no memory for stacks is a limit that root has, too
    std::size_t pages = 0;
    std::ifstream("/proc/self/statm") >> pages;
    const rlim_t bytes = pages * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE)) + (20u << 20);
    const rlimit limit{bytes, bytes};
    ::setrlimit(RLIMIT_AS, &limit);
    std::vector<std::atomic<int>> done(1000);
    try {
      parallel_for(done.size(), 500, [&](std::uint64_t i) { ++done[i]; });
    } catch (const std::exception&) {
      ::_exit(8);
    }
    ::_exit(std::all_of(done.begin(), done.end(), [](const auto& times) { return times == 1; }) ? 0 : 7);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 0);
}

TEST(Parallel, RethrowsAndStops) {
  std::atomic<int> done = 0;
  const auto work = [&](std::uint64_t i) {
    if (i == 0) throw std::runtime_error("item 0");
    ++done;
  };
  EXPECT_EQ(test::refusal([&] { parallel_for(1, 4, work); }), "item 0");
  EXPECT_EQ(test::refusal([&] { parallel_for(100'000'000, 2, work); }), "item 0");
  EXPECT_LT(done, 100'000'000);
}

TEST(Parallel, ProgressAscendsToTheTotal) {
  std::vector<std::uint64_t> seen;
  parallel_for(
      500, 3, [](std::uint64_t) {},
      [&](std::uint64_t done, std::uint64_t total) {
        EXPECT_EQ(total, 500u);
        seen.push_back(done);
      });
  EXPECT_TRUE(std::is_sorted(seen.begin(), seen.end()));
  EXPECT_TRUE(std::all_of(seen.begin(), seen.end(), [](std::uint64_t done) { return done <= 500; }));
}

TEST(Random, IsSplitMix64) {
  Random random(1234567);  // reference values of the authors' code for this seed
  EXPECT_EQ(random.next(), 6457827717110365317u);
  EXPECT_EQ(random.next(), 3203168211198807973u);
}

TEST(Random, NumbersStayInRangeAndCoverIt) {
  Random random(7);
  std::map<std::uint32_t, int> counts;
  for (int i = 0; i < 10'000; ++i) {
    ++counts[random.below(10)];
    const float unit = random.unit(), between = random.between(-2, 3);
    ASSERT_TRUE(unit >= 0 && unit < 1);
    ASSERT_TRUE(between >= -2 && between <= 3);
  }
  ASSERT_EQ(counts.size(), 10u);
  for (const auto& [value, times] : counts) EXPECT_NEAR(times, 1000, 150) << value;
}

TEST(Random, StreamsDoNotRepeatOneAnother) {
  Random first(7, 0), second(7, 1), again(7, 1);
  EXPECT_NE(first.next(), second.next());
  again.next();
  EXPECT_EQ(second.next(), again.next());
}

}  // namespace
}  // namespace vismat
