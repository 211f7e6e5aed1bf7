// rows-small and rows-quick: what the tests of every codec do not try.
#include "codecs/modelled/modelled_rows.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <string>

#include "codecs/modelled/binary_coder.h"
#include "codecs/modelled/row_encoder.h"
#include "codecs/modelled/row_references.h"
#include "codecs/rows/row_codec.h"
#include "codecs/vmat/container.h"
#include "codecs/vmat/row_reader.h"
#include "tests/codecs/matrices.h"
#include "tests/sanitized.h"
#include "tests/table_name.h"

namespace vismat {
namespace {

// View cells on a line that see a stretch of it, each its own, so that no two rows are equal and near ones are alike.
VisibilityMatrix cells_on_a_line(std::uint32_t rows, std::uint32_t columns, std::uint64_t seed) {
  Random random(seed);
  std::vector<std::vector<std::uint32_t>> lists(rows);
  std::vector<bool> seen(columns);
  for (auto& list : lists) {
    for (int change = 0; change < 3; ++change) {
      const std::uint32_t from = random.below(columns), length = 1 + random.below(30);
      const bool value = random.below(2) == 0;
      for (std::uint32_t c = from; c < std::min(columns, from + length); ++c) seen[c] = value;
    }
    for (std::uint32_t c = 0; c < columns; ++c) {
      if (seen[c]) list.push_back(c);
    }
  }
  return VisibilityMatrix::from_rows(lists, columns);
}

class ModelledRows : public testing::TestWithParam<Codec> {};

TEST_P(ModelledRows, ReadsRowsInAnyOrderWithOneBuffer) {
  const auto matrix = cells_on_a_line(test::trials(500u), 600, 1);
  const std::uint32_t rows = matrix.shape().rows;
  for (const bool may_move : {false, true}) {
    const auto file = write_container(compress(matrix, GetParam(), {}, {.rows_may_move = may_move}));
    const RowReader reader(file, std::span(&GetParam(), 1));
    const auto order = reader.source().row_order;
    ASSERT_EQ(order.has_value(), may_move);
    const auto stored = order ? permute(matrix, *order, Permutation::identity(600)) : matrix;
    RowBuffer<std::uint32_t> buffer;
    Random random(2);
    std::uint32_t row = 0;
    for (std::uint32_t i = 0; i < 20 * rows; ++i) {
      // Runs of rows that follow one another, either way, and jumps.
      row = i % 50 == 0 ? random.below(rows) : (row + (i % 100 < 70 ? 1 : rows - 1)) % rows;
      ASSERT_TRUE(std::ranges::equal(reader.ids(row, buffer), stored.row(row))) << row;
    }
  }
}

TEST_P(ModelledRows, TakeAtMostSixteenBytesMoreThanTheBitmapForARow) {
  const std::uint32_t widest = test::sanitized ? 1u << 16 : 5u << 17;  // of more than 2^16 bytes
  std::vector<VisibilityMatrix> matrices;
  for (const std::uint32_t columns : {1u, 2u, 3u, 15u, 16u, 17u, 63u, 64u, 65u, 1000u}) {
    for (const double density : {.02, .5, 2.})
      matrices.push_back(test::random_matrix({20, columns}, density, columns));
    std::vector<std::vector<std::uint32_t>> combs(20);  // each column another value than the one before
    for (std::uint32_t r = 0; r < 20; ++r) {
      for (std::uint32_t c = r % 2; c < columns; c += 2 + r / 8) combs[r].push_back(c);
    }
    matrices.push_back(VisibilityMatrix::from_rows(combs, columns));
  }
  matrices.push_back(test::random_matrix({2, widest}, .5, 7));
  std::vector<std::vector<std::uint32_t>> wide(6);
  for (std::uint32_t c = 0; c < widest; ++c) wide[c % 5].push_back(c);
  wide[5] = {0, (widest)-1};
  matrices.push_back(VisibilityMatrix::from_rows(wide, widest));
  for (const VisibilityMatrix& matrix : matrices) {
    const auto [rows, columns] = matrix.shape();
    const Encoded encoded = GetParam().encode(matrix, {}, {});
    EXPECT_LE(encoded.bytes(), rows * (row_bytes_of(columns) + 16)) << columns << " columns";
    EXPECT_TRUE(decode(GetParam(), encoded, matrix.shape()) == matrix) << columns << " columns";
  }
}

TEST_P(ModelledRows, AreSmallestInTheirOwnOrder) {
  for (std::uint64_t seed = 1; seed <= test::trials(std::uint64_t{3}); ++seed) {
    const auto matrix = cells_on_a_line(300, 400, seed);
    const Encoded moved = GetParam().encode(matrix, {}, {.rows_may_move = true});
    const auto ordered = permute(matrix, moved.row_order.value(), Permutation::identity(400));
    EXPECT_EQ(decode(GetParam(), moved, ordered.shape()), ordered);
    EXPECT_LT(moved.bytes(), GetParam().encode(matrix, {}, {}).bytes());
  }
}

TEST_P(ModelledRows, AreTheSameForAnyNumberOfThreads) {
  const auto matrix = cells_on_a_line(200, 300, 4);
  for (const bool may_move : {false, true}) {
    const auto with = [&](unsigned threads) {
      return GetParam().encode(matrix, {}, {.threads = threads, .rows_may_move = may_move});
    };
    EXPECT_EQ(with(1), with(3));
  }
}

TEST_P(ModelledRows, RefuseRowsThatNoBytesBack) {
  const Encoded hostile{{}, {std::byte{0}}};
  EXPECT_THROW(decode(GetParam(), hostile, {0xffffffff, 1}), FormatError);
}

INSTANTIATE_TEST_SUITE_P(Table, ModelledRows, testing::ValuesIn(modelled_codecs()), test::table_name);

// The time of each row with all that it takes, as the plan's own model has it.
double longest_chain(const VisibilityMatrix& matrix, const RowLimits& limits, bool may_move) {
  const RowEnds ends(matrix);
  const RowPlan plan = plan_rows(ends, limits, {.rows_may_move = may_move});
  const auto ends_of = [&](std::uint32_t place) {
    return ends[place == no_row ? ends.rows() : plan.order[place]];
  };
  std::vector<double> times(ends.rows());
  double longest = 0;
  std::uint32_t row = plan.kept;
  for (const std::uint32_t size : plan.group_sizes) {
    const std::uint32_t outside = plan.reference[row];
    double time = outside == no_row ? 0 : times[outside];
    for (const std::uint32_t end = row + size; row < end; ++row) {
      const std::uint32_t a = plan.reference[row], b = a == no_row ? no_row : plan.reference[a];
      time += cost_of_row(ends_of(a), ends_of(b), ends_of(row), ends.columns()).microseconds;
      times[row] = time;
      longest = std::max(longest, time);
    }
  }
  return longest;
}

TEST(RowPlan, BoundsTheTimeOfARow) {
  const auto matrix = cells_on_a_line(600, 400, 5);
  const RowLimits unbounded{1e9, 1e9, 16, 16}, bounded{8, 1e9, 8, 16};
  EXPECT_GT(longest_chain(matrix, unbounded, true), 3 * bounded.microseconds);
  EXPECT_LE(longest_chain(matrix, bounded, true), bounded.microseconds);
  EXPECT_LE(longest_chain(matrix, bounded, false), bounded.microseconds);
}

TEST(BinaryCoder, ReadsWhatItWrote) {
  Random random(6);
  for (int length = 0; length < 300; ++length) {
    std::vector<std::uint32_t> chances, values;
    std::vector<std::byte> bytes;
    BinaryWriter writer(bytes);
    for (int i = 0; i < length; ++i) {
      const bool bit = random.below(3) != 0;
      chances.push_back(random.below(4) == 0 ? 1 + random.below(3) : 1 + random.below(65535));
      values.push_back(bit ? random.below(2) : random.below(chances.back()));
      if (bit)
        writer.put_bit(values.back() != 0, chances.back());
      else
        writer.put_even(chances.back(), values.back());
      chances.push_back(bit);
    }
    writer.finish();
    const auto read = [&](std::span<const std::byte> from) {
      BinaryReader reader(from);
      bool right = true;
      for (std::size_t i = 0; i < values.size(); ++i)
        right &=
            values[i] == (chances[2 * i + 1] != 0 ? reader.bit(chances[2 * i]) : reader.even(chances[2 * i]));
      reader.finish();
      return right;
    };
    EXPECT_TRUE(read(bytes));
    const auto refused = [&](const std::vector<std::byte>& other) {
      try {
        return !read(other);
      } catch (const FormatError&) {
        return true;
      }
    };
    auto more = bytes;
    more.push_back(std::byte{0});
    EXPECT_TRUE(refused(more));
    more.back() = std::byte{1};
    EXPECT_TRUE(refused(more));
    if (bytes.empty()) continue;
    EXPECT_TRUE(refused({bytes.begin(), bytes.end() - 1}));
  }
}

}  // namespace
}  // namespace vismat
