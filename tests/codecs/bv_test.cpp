// bv: the bits of every row against a count that knows only the paper's rules, the choice of references, and hostile bytes.
#include <gtest/gtest.h>

#include <algorithm>
#include <iterator>
#include <optional>

#include "codecs/baselines/baseline_codecs.h"
#include "codecs/rows/bv.h"
#include "codecs/vmat/container.h"
#include "codecs/vmat/row_reader.h"
#include "tests/codecs/matrices.h"

namespace vismat {
namespace {

using Ids = std::vector<std::uint32_t>;

// The bits of the codes, by their definitions [Boldi, Vigna 2004; 2005].
std::size_t gamma(std::uint64_t n) {
  std::size_t digits = 0;  // of n + 1, before which stand as many zeros but one
  for (std::uint64_t x = n + 1; x > 0; x /= 2) ++digits;
  return digits - 1 + digits;
}
std::size_t zeta(std::uint64_t n) {
  const std::uint64_t x = n + 1;
  std::uint64_t h = 0;
  while (x >= std::uint64_t{1} << (3 * (h + 1))) ++h;
  const std::uint64_t size = (std::uint64_t{7} << (3 * h)), v = x - (std::uint64_t{1} << (3 * h));
  std::size_t width = 0;  // minimal binary code of v < size
  while ((std::uint64_t{1} << width) < size) ++width;
  const bool shorter = v < (std::uint64_t{1} << width) - size;
  return h + 1 + width - shorter;
}
std::uint64_t natural(std::int64_t n) {
  return static_cast<std::uint64_t>(n >= 0 ? 2 * n : -2 * n - 1);
}

// Bits of a row against a reference: by sets and what is left of them, nothing else.
std::size_t bits_by_rules(const Ids& row, const std::optional<Ids>& reference, std::uint32_t x,
                          std::uint32_t r) {
  std::size_t bits = gamma(row.size()) + r + 1;
  Ids extra = row;
  if (reference) {
    extra.clear();
    std::ranges::set_difference(row, *reference, std::back_inserter(extra));
    std::vector<std::size_t> blocks;  // of ids of the reference: copied, not copied, and so on
    bool expected = true;
    std::size_t block = 0, at = 0;
    for (const std::uint32_t id : *reference) {
      while (at < row.size() && row[at] < id) ++at;
      const bool common = at < row.size() && row[at] == id;
      if (common != expected) {
        blocks.push_back(block);
        block = 0;
        expected = common;
      }
      ++block;
    }
    bits += gamma(blocks.size());  // the last one is what is left
    for (std::size_t b = 0; b < blocks.size(); ++b) bits += gamma(b == 0 ? blocks[b] : blocks[b] - 1);
  }
  if (extra.empty()) return bits;
  std::vector<std::pair<std::int64_t, std::int64_t>> intervals;  // first, last
  Ids residuals;
  for (std::size_t i = 0; i < extra.size();) {
    std::size_t j = i + 1;
    while (j < extra.size() && extra[j] == extra[j - 1] + 1) ++j;
    if (j - i >= 4)
      intervals.emplace_back(extra[i], extra[j - 1]);
    else
      residuals.insert(residuals.end(), extra.begin() + static_cast<std::ptrdiff_t>(i),
                       extra.begin() + static_cast<std::ptrdiff_t>(j));
    i = j;
  }
  bits += gamma(intervals.size());
  for (std::size_t i = 0; i < intervals.size(); ++i) {
    const auto [first, last] = intervals[i];
    bits += i == 0 ? gamma(natural(first - x))
                   : gamma(static_cast<std::uint64_t>(first - intervals[i - 1].second - 2));
    bits += gamma(static_cast<std::uint64_t>(last - first + 1 - 4));
  }
  for (std::size_t i = 0; i < residuals.size(); ++i)
    bits +=
        i == 0 ? zeta(natural(std::int64_t{residuals[0]} - x)) : zeta(residuals[i] - residuals[i - 1] - 1);
  return bits;
}

Ids ids_of(const VisibilityMatrix& matrix, std::uint32_t row) {
  return {matrix.row(row).begin(), matrix.row(row).end()};
}

// Every row takes what its cheapest reference takes, of those that the window and the chains allow.
TEST(Bv, TakesTheBitsOfTheCheapestReference) {
  std::size_t rows_in_all = 0, referring = 0, longest = 0;
  for (const auto& matrix : {test::clustered_matrix({60, 500}, 3), test::random_matrix({30, 300}, .05, 4),
                             test::banded_matrix(40, 12, 1), test::clustered_matrix({40, 6000}, 8)}) {
    const auto [rows, columns] = matrix.shape();
    const Encoded encoded = detail::encode_rows<BvRows>(matrix, {}, {});
    const Parts parts(encoded);
    std::vector<std::uint32_t> chain(rows, 0);
    rows_in_all += rows;
    for (std::uint32_t x = 0; x < rows; ++x) {
      const Ids row = ids_of(matrix, x);
      if (row.empty()) {
        EXPECT_EQ(parts.part_bytes(x), 0u);
        continue;
      }
      std::size_t least = bits_by_rules(row, {}, x, 0);
      for (std::uint32_t r = 1; r <= std::min(7u, x); ++r) {
        if (chain[x - r] >= 3 || matrix.row(x - r).empty()) continue;
        const std::size_t bits = bits_by_rules(row, ids_of(matrix, x - r), x, r);
        if (bits >= least) continue;
        least = bits;
        chain[x] = chain[x - r] + 1;
      }
      const std::size_t bitmap = (columns + 7) / 8;
      if ((least + 7) / 8 >= bitmap) chain[x] = 0;
      EXPECT_EQ(parts.part_bytes(x), std::min((least + 7) / 8, bitmap)) << "row " << x;
      referring += chain[x] > 0;
      longest = std::max<std::size_t>(longest, chain[x]);
    }
  }
  EXPECT_EQ(longest, 3u);
  EXPECT_GT(referring, rows_in_all / 3);
}

TEST(Bv, ReadsRowsThroughTheirReferences) {
  const auto matrix = test::clustered_matrix({80, 900}, 6);
  const auto file = write_container(compress(matrix, find_codec("bv")));
  const RowReader reader(file);
  RowBuffer<std::uint32_t> ids;
  std::uint64_t most = 0;
  for (std::uint32_t r = 80; r-- > 0;) {
    EXPECT_TRUE(std::ranges::equal(reader.ids(r, ids), matrix.row(r)));
    most = std::max(most, reader.cost(r).parts);
  }
  EXPECT_EQ(most, 4u);
}

TEST(Bv, ReadsRowsOfAMillionColumns) {
  constexpr std::uint32_t columns = 1 << 20;
  Ids full(columns), most;
  for (std::uint32_t c = 0; c < columns; ++c) {
    full[c] = c;
    if (c % 70000 > 3) most.push_back(c);
  }
  const auto matrix = VisibilityMatrix::from_rows(
      {full, {}, most, {0, 65535, columns - 1}, full, most, {columns - 1}}, columns);
  const Container container = compress(matrix, find_codec("bv"));
  EXPECT_LT(container.encoded.bytes(), 400u);
  EXPECT_EQ(decompress(container, find_codec("bv")), matrix);
}

// A chain of four references, a reference before row 0, and an interval that claims 2^32 columns.
TEST(Bv, RefusesWhatNoEncoderMakes) {
  const auto refused = [](std::vector<std::vector<unsigned>> rows, std::uint32_t columns) {
    Encoded encoded;
    std::vector<std::uint64_t> starts;
    for (const auto& row : rows) {
      starts.push_back(encoded.payload.size());
      for (const unsigned byte : row) encoded.payload.push_back(static_cast<std::byte>(byte));
    }
    encoded.index = part_index_bytes(starts, encoded.payload.size());
    try {
      decode(find_codec("bv"), encoded, {static_cast<std::uint32_t>(rows.size()), columns});
    } catch (const FormatError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  // 1 id (010), no reference (1), no interval (1), residual x + 0: zeta of 1 is 1, then 00.
  const std::vector<unsigned> first = {0b00'1'1'1'010};
  const std::vector<unsigned> copy = {0b1'10'010};  // 1 id, the row before, no block: all is copied
  EXPECT_EQ(refused({first, copy, copy, copy}, 100), "");
  EXPECT_NE(refused({first, copy, copy, copy, copy}, 100).find("more than 3 references"), std::string::npos);
  EXPECT_NE(refused({copy}, 100).find("1 rows back from row 0"), std::string::npos);
  EXPECT_NE(refused({{0, 0, 0, 0, 1}}, 100), "");
}

}  // namespace
}  // namespace vismat
