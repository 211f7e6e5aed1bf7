// The worst rows of each code for gaps and runs are as bad as the headers say, and no worse than their bitmap with the escape.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "codecs/entropy/ans.h"
#include "codecs/integer_codes/interpolative.h"
#include "codecs/integer_codes/lzw.h"
#include "codecs/integer_codes/pair_huffman.h"
#include "codecs/integer_codes/rice.h"
#include "codecs/integer_codes/universal_codes.h"
#include "codecs/rows/elias_fano_rows.h"
#include "codecs/rows/pairs.h"
#include "codecs/vmat/container.h"
#include "codecs/vmat/row_reader.h"
#include "tests/codecs/coded_lists.h"
#include "tests/codecs/matrices.h"

namespace vismat {
namespace {

using Numbers = std::vector<std::uint32_t>;
using Bytes = std::vector<std::byte>;
using test::code_lists;

template <typename Code>
std::size_t bytes_of_row(const std::vector<std::uint32_t>& ids) {
  Numbers memory;
  const auto numbers = pairs_of_row(ids, memory);
  return code_lists<Code>({{numbers.begin(), numbers.end()}}).lists[0].size();
}

std::vector<std::uint32_t> twos(std::uint32_t columns) {  // two zeros, two ones ...
  std::vector<std::uint32_t> ids;
  for (std::uint32_t c = 0; c < columns; ++c) {
    if (c % 4 >= 2) ids.push_back(c);
  }
  return ids;
}

std::vector<std::uint32_t> random_row(std::uint32_t columns, std::uint32_t one_in, std::uint64_t seed) {
  Random random(seed);
  std::vector<std::uint32_t> ids;
  for (std::uint32_t c = 0; c < columns; ++c) {
    if (random.below(one_in) == 0) ids.push_back(c);
  }
  return ids;
}

std::vector<std::vector<std::uint32_t>> adversarial_rows(std::uint32_t columns) {
  std::vector<std::vector<std::uint32_t>> rows = {{}, {0}, {columns - 1}, {0, columns - 1}, twos(columns)};
  std::vector<std::uint32_t> even, odd, full;
  for (std::uint32_t c = 0; c < columns; ++c) {
    full.push_back(c);
    (c % 2 == 0 ? even : odd).push_back(c);
  }
  rows.insert(rows.end(), {even, odd, full});
  for (const std::uint32_t one_in : {2u, 3u, 10u, 100u}) rows.push_back(random_row(columns, one_in, one_in));
  std::vector<std::uint32_t> growing;  // every gap and every run another symbol
  for (std::uint32_t c = 0, length = 1; c < columns; c += 2 * length, ++length) {
    for (std::uint32_t i = 0; i < length && c + length + i < columns; ++i) growing.push_back(c + length + i);
  }
  rows.push_back(growing);
  return rows;
}

TEST(WorstRow, OfGammaTakesThreeHalvesOfItsColumnsAndOfDeltaTwice) {
  const std::uint32_t columns = 8000;
  // the first gap is told as 3, the list's end takes a bit
  EXPECT_EQ(bytes_of_row<GammaCode>(twos(columns)), columns * 3 / 2 / 8 + 1);
  EXPECT_EQ(bytes_of_row<DeltaCode>(twos(columns)), columns * 2 / 8 + 1);
  for (const auto& ids : adversarial_rows(columns)) {
    EXPECT_LE(bytes_of_row<GammaCode>(ids), columns * 3 / 2 / 8 + 1);
    EXPECT_LE(bytes_of_row<DeltaCode>(ids), columns * 2 / 8 + 1);
  }
  for (std::uint32_t x = 1; x < 100000; ++x) {
    const auto n = static_cast<std::uint32_t>(std::bit_width(x));
    EXPECT_LE(2 * (2 * n - 1), 3 * x);
    EXPECT_LE(n - 1 + 2 * static_cast<std::uint32_t>(std::bit_width(n)) - 1, 2 * x);
  }
}

TEST(WorstRow, OfRiceTakes98BitsFor67Columns) {
  const auto cost = [](std::uint32_t x, unsigned k) {
    const std::uint32_t quotient = (x - 1) >> k;
    return quotient < 24 ? quotient + 1 + k : 56;
  };
  for (std::uint32_t x = 1; x < 1000; ++x) EXPECT_LE(36 * cost(x, 0) + 31 * cost(x, 1), 98 * x) << x;
  const auto bound =
      [](std::uint64_t columns) {  // the first number is counted from 1; parameters, end, padding
        return 1 + (98 * (columns + 1) / 67 + 1 + 7) / 8;
      };
  for (const std::uint32_t columns : {17u, 64u, 999u, 8000u}) {
    for (const auto& ids : adversarial_rows(columns))
      EXPECT_LE(bytes_of_row<RiceCode>(ids), bound(columns)) << columns;
  }
  std::vector<std::uint32_t> worst;
  std::uint32_t columns = 0;
  for (std::uint32_t i = 0; i < 43 * 50; ++i) {
    const std::uint32_t length = i % 43 == 0 ? 25 : 1;
    columns += length;
    for (std::uint32_t j = 0; j < length; ++j) worst.push_back(columns++);
  }
  EXPECT_LE(bytes_of_row<RiceCode>(worst), bound(columns));
  EXPECT_GE(bytes_of_row<RiceCode>(worst), std::size_t{columns} * 98 / 67 / 8);
}

TEST(WorstRow, OfInterpolativeCodeTakesItsSlackOnceALevel) {
  for (const std::uint32_t columns : {17u, 999u, 8000u}) {
    for (const auto& ids : adversarial_rows(columns)) {
      Numbers memory;
      const auto numbers = pairs_of_row(ids, memory);
      if (numbers.empty()) continue;
      std::uint64_t sum = 0;
      for (const std::uint32_t number : numbers) sum += number;
      const auto levels = static_cast<std::uint64_t>(std::bit_width(numbers.size() - 1));
      EXPECT_LE(bytes_of_row<InterpolativeCode>(ids), 6 + (sum - numbers.size()) * levels / 8 + 1);
    }
  }
  std::size_t most = 0;
  for (std::size_t place = 0; place < 256; ++place) {
    Numbers list(256, 1);
    list[place] = 2;
    most = std::max(most, code_lists<InterpolativeCode>({list}).lists[0].size());
  }
  EXPECT_EQ(most, 3u + 2u);  // two varints; 8 levels and the end
}

TEST(WorstRow, OfHuffmanWithItsOwnTableHasEveryNumberOnce) {
  Numbers list;
  for (std::uint32_t s = 0; s < LengthSymbol::count; ++s) list.push_back(length_of_symbol(s, 0));
  std::size_t raw_bits = 0;
  for (std::uint32_t s = 0; s < LengthSymbol::count; ++s) raw_bits += raw_bits_of_symbol(s);
  const std::size_t size = code_lists<OwnHuffmanCode>({list}).lists[0].size();
  EXPECT_GE(size, list.size() * 7 / 8 + raw_bits / 8);
  EXPECT_LE(size, 1 + list.size() + (list.size() * 8 + raw_bits) / 8 + 1);
}

// A number rare in the file, alone in its list: up to 15 bits of shared Huffman, 11 and a state of shared ANS, raw bits.
TEST(WorstRow, OfSharedTablesHasWhatIsRareElsewhere) {
  const Numbers rare = {0xffffffff};
  std::vector<Numbers> lists = {rare};
  std::uint32_t weight = 1, before = 1;
  for (std::uint32_t s = 1; s < 30; ++s) {  // as Fibonacci's numbers, for the longest codes
    for (std::uint32_t i = 0; i < weight; ++i) lists.push_back({s});
    weight = std::exchange(before, before + weight);
    if (weight > 30000) break;
  }
  EXPECT_EQ(code_lists<SharedHuffmanCode>(lists).lists[0].size(), (15u + 29u + 1u + 7u) / 8);
  EXPECT_EQ(code_lists<AnsCode>(lists).lists[0].size(), (11u + 11u + 29u + 1u + 7u) / 8);
}

TEST(WorstRow, OfLzwRepeatsNoPairOfBytes) {
  Numbers list;  // pairs of bytes below 128, each pair once
  for (std::uint32_t step = 1; step < 64; ++step) {
    for (std::uint32_t i = 0; i < 127; ++i) list.push_back(1 + i * step % 127);
  }
  const std::size_t size = code_lists<LzwCode>({list}).lists[0].size();
  EXPECT_GT(size, list.size() * 14 / 10);
  EXPECT_LE(size, list.size() * 12 / 8 + 1);
}

TEST(WorstRow, OfEliasFanoIsTheFullOne) {
  for (const std::uint32_t columns : {17u, 999u, 8000u}) {
    EliasFanoRows rows{columns};
    for (const auto& ids : adversarial_rows(columns)) {
      Bytes bytes;
      rows.encode(ids, bytes);
      const auto n = static_cast<double>(ids.size()), c = static_cast<double>(columns);
      const double bits = ids.empty() ? 0 : n * 2 >= c ? n + c : n * (std::log2(c / n) + 3);
      EXPECT_LE(static_cast<double>(bytes.size()), bits / 8 + 5) << ids.size() << " of " << columns;
      EXPECT_TRUE(ids.size() < columns || bytes.size() >= columns / 4);
    }
  }
}

TEST(WorstRow, IsNeverLargerThanItsBitmapWhereARowStandsAlone) {
  std::vector<VisibilityMatrix> matrices;
  for (const std::uint32_t columns : {3u, 9u, 10u, 11u, 66u, 1002u, 20002u})
    matrices.push_back(VisibilityMatrix::from_rows(adversarial_rows(columns), columns));
  for (const Codec& codec : own_codecs()) {
    // Codecs of engines have no escape; those over trees are none of single rows.
    if (!codec.rows_alone() || codec.origin == Origin::baseline) continue;
    if (codec.orders_rows) continue;  // its rows share parts; modelled_rows_test.cpp has their bound
    for (const VisibilityMatrix& matrix : matrices) {
      const auto file = write_container(compress(matrix, codec));
      const RowReader reader(file);
      RowBuffer<std::uint32_t> ids;
      for (std::uint32_t r = 0; r < matrix.shape().rows; ++r) {
        if (codec.rows_per_part == 1 && reader.cost(r).parts == 1) {
          EXPECT_LE(reader.cost(r).bytes, row_bytes_of(matrix.shape().columns))
              << codec.name << ", row " << r;
        }
        EXPECT_TRUE(std::ranges::equal(reader.ids(r, ids), matrix.row(r))) << codec.name << ", row " << r;
      }
    }
  }
}

// The index and what a part tells of its rows are these 16 bytes at most.
TEST(WorstRow, IsLittleLargerThanItsBitmapWithEveryCodecOfOurs) {
  std::vector<VisibilityMatrix> matrices;
  for (const std::uint32_t columns : {3u, 10u, 65u, 67u, 1002u, 12002u}) {
    auto rows = adversarial_rows(columns);
    for (std::uint64_t seed = 0; seed < 8; ++seed) rows.push_back(random_row(columns, 2, 50 + seed));
    matrices.push_back(VisibilityMatrix::from_rows(rows, columns));
  }
  for (const Codec& codec : own_codecs()) {
    if (!codec.rows_alone() || codec.origin == Origin::baseline) continue;
    for (const VisibilityMatrix& matrix : matrices) {
      const auto [rows, columns] = matrix.shape();
      const std::uint64_t bytes = compress(matrix, codec).encoded.bytes(),
                          model = codec.encode(VisibilityMatrix({0, columns}), {}, {}).bytes();
      // A model of all rows (Huffman codes and the like) is no row's.
      EXPECT_LE(bytes, rows * (row_bytes_of(columns) + 16) + std::max<std::uint64_t>(model, 600))
          << codec.name << ", " << columns;
    }
  }
}

}  // namespace
}  // namespace vismat
