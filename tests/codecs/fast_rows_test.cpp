// rows-fast-ids and rows-fast-bits by each set of instructions: the same rows and the same refusals, judged by the
// matrix that was encoded.
#include <gtest/gtest.h>

#include <algorithm>

#include "codecs/baselines/baseline_codecs.h"
#include "codecs/rows/fast_bits.h"
#include "codecs/rows/fast_ids.h"
#include "codecs/vmat/container.h"
#include "codecs/vmat/row_reader.h"
#include "tests/codecs/matrices.h"
#include "tests/simd_here.h"

namespace vismat {
namespace {

using Ids = std::vector<std::uint32_t>;

VisibilityMatrix wide_matrix() {
  constexpr std::uint32_t columns = 1 << 20;
  Ids full(columns), tail = {0, 1, 255, 256, 65535, 65536, 65537, columns - 1};
  for (std::uint32_t c = 0; c < columns; ++c) full[c] = c;
  return VisibilityMatrix::from_rows({full, {}, tail, {columns - 1}, {0}, full}, columns);
}

VisibilityMatrix adversarial_matrix(std::uint32_t columns) {
  std::vector<Ids> rows(6);
  for (std::uint32_t c = 0; c < columns; ++c) {
    if (c % 2 == 0) rows[0].push_back(c);
    if (c % 2 == 1) rows[1].push_back(c);
    if (c % 4 >= 2) rows[2].push_back(c);
    if (c % 64 == 63) rows[3].push_back(c);
    if (c % 64 < 8) rows[4].push_back(c);
    if (c / 3 % 5 != 1) rows[5].push_back(c);
  }
  return VisibilityMatrix::from_rows(rows, columns);
}

std::vector<test::NamedMatrix> matrices() {
  auto all = test::assorted_matrices();
  all.push_back({"2^20 columns", wide_matrix()});
  for (const std::uint32_t columns : {1u, 63u, 64u, 65u, 511u, 512u, 513u, 4097u})
    all.push_back({"adversarial, " + std::to_string(columns), adversarial_matrix(columns)});
  all.push_back({"many words", test::clustered_matrix({9, 9000}, 5)});
  return all;
}

// The row's ids in each of the three forms, which must agree; or the message of the refusal in `message`.
template <typename Rows>
Ids decoded(const Rows& rows, std::span<const std::byte> part, std::uint32_t row, std::uint32_t columns,
            std::string* message = nullptr) {
  const auto decode = [&](auto& sink, RowScratch& scratch) {
    if (part.size() == row_bytes_of(columns) && detail::escapes<Rows>()) return get_bitmap_row(part, sink);
    if constexpr (requires { rows.decode(part, row, scratch, sink); })
      rows.decode(part, row, scratch, sink);
    else
      rows.decode(part, sink);
  };
  try {
    RowBuffer<std::uint32_t> ids;
    IdSink id_sink(ids, columns, columns);
    decode(id_sink, ids);
    id_sink.finish();
    RowBuffer<vismat::Run> runs;
    RunSink run_sink(runs, columns, columns);
    decode(run_sink, runs);
    run_sink.finish();
    constexpr bool writes_all = requires {
      Rows::writes_all_words;
    };
    std::vector<std::uint64_t> words((std::size_t{columns} + 63) / 64 + 1, writes_all ? 0x55 : 0);
    words.back() = 42;  // belongs to somebody else
    BitSink bit_sink(std::span<std::uint64_t>(words).first(words.size() - 1), columns, columns);
    decode(bit_sink, ids);
    EXPECT_EQ(words.back(), 42u);
    const Ids content(ids.content().begin(), ids.content().end());
    Ids of_runs, of_bits;
    for (const vismat::Run run : runs.content()) {
      for (std::uint32_t i = 0; i < run.count; ++i) of_runs.push_back(run.first + i);
    }
    for (std::uint32_t c = 0; c < 64 * (words.size() - 1); ++c) {
      if ((words[c / 64] >> (c % 64) & 1) != 0) of_bits.push_back(c);
    }
    EXPECT_EQ(content, of_runs);
    EXPECT_EQ(content, of_bits);
    return content;
  } catch (const FormatError& error) {
    if (message == nullptr) throw;
    *message = error.what();
    return {};
  }
}

template <typename Rows>
class FastRows : public testing::Test {};
using Both = testing::Types<FastIdRows, FastBitRows>;
TYPED_TEST_SUITE(FastRows, Both);

TYPED_TEST(FastRows, AreTheSameByAllInstructions) {
  for (const auto& [name, matrix] : matrices()) {
    const Encoded encoded = detail::encode_rows<TypeParam>(matrix, {}, {});
    const Parts parts(encoded);
    for (const Simd simd : test::simd_here()) {
      ByteReader model(parts.model(), "model");
      TypeParam rows = TypeParam::read_model(model, matrix.shape());
      rows.simd = simd;
      constexpr std::uint32_t step = detail::rows_per_part<TypeParam>();
      for (std::uint32_t r = 0; r < matrix.shape().rows; ++r) {
        const Ids ids = decoded(rows, parts.part(r / step), r % step, matrix.shape().columns);
        ASSERT_TRUE(std::ranges::equal(ids, matrix.row(r)))
            << name << ", row " << r << ", " << static_cast<int>(simd);
      }
    }
  }
}

// Each bit flipped, each byte left out and each byte doubled, in a copy that ends where its memory ends.
TYPED_TEST(FastRows, RefuseTheSameByAllInstructions) {
  const auto matrix = test::clustered_matrix({8, 700}, 21);
  const Encoded encoded = detail::encode_rows<TypeParam>(matrix, {}, {});
  const Parts parts(encoded);
  std::size_t refused = 0;
  for (std::uint64_t p = 0; p < parts.count(); ++p) {
    const auto good = parts.part(p);
    std::vector<std::vector<std::byte>> bad;
    for (std::size_t bit = 0; bit < 8 * good.size(); ++bit) {
      bad.emplace_back(good.begin(), good.end())[bit / 8] ^= std::byte{1} << (bit % 8);
      if (bit % 8 != 0) continue;
      auto& shorter = bad.emplace_back(good.begin(), good.end());
      shorter.erase(shorter.begin() + static_cast<std::ptrdiff_t>(bit / 8));
      auto& longer = bad.emplace_back(good.begin(), good.end());
      longer.insert(longer.begin() + static_cast<std::ptrdiff_t>(bit / 8), good[bit / 8]);
    }
    for (auto& bytes : bad) {
      bytes.shrink_to_fit();
      std::vector<std::pair<Ids, bool>> outcomes;
      for (const Simd simd : test::simd_here()) {
        ByteReader model(parts.model(), "model");
        TypeParam rows = TypeParam::read_model(model, matrix.shape());
        rows.simd = simd;
        std::string message;
        auto ids = decoded(rows, bytes, detail::rows_per_part<TypeParam>() - 1, 700, &message);
        outcomes.emplace_back(std::move(ids), !message.empty());
      }
      refused += outcomes.front().second;
      for (const auto& outcome : outcomes) ASSERT_EQ(outcome, outcomes.front());
    }
  }
  EXPECT_GT(refused, 100u);
}

TEST(FastIds, TakesClassesForWhatIsFrequent) {
  // Runs of 3 behind gaps of 7: one byte each, and the first gap's.
  Ids row;
  for (std::uint32_t c = 7; c + 3 < 1000; c += 10) row.insert(row.end(), {c, c + 1, c + 2});
  const auto matrix = VisibilityMatrix::from_rows({row, row}, 1000);
  const Encoded encoded = detail::encode_rows<FastIdRows>(matrix, {}, {});
  EXPECT_EQ(Parts(encoded).part_bytes(1), row.size() / 3);
}

TEST(FastBits, SharesWhatRowsHaveInCommon) {
  const VisibilityMatrix matrix = test::clustered_matrix({30, 5000}, 3);
  const Ids ids(matrix.row(29).begin(), matrix.row(29).end());
  const auto bytes_of = [](const std::vector<Ids>& rows) {
    return Parts(detail::encode_rows<FastBitRows>(VisibilityMatrix::from_rows(rows, 5000), {}, {}))
        .part_bytes(0);
  };
  EXPECT_LE(bytes_of({ids, ids, ids, ids}), bytes_of({ids, {}, {}, {}}) + 20);
}

// `most` bounds what a row may hold also where whole words are written.
TEST(FastBits, RefusesMoreOnesThanTheFileStates) {
  Container container = compress(test::random_matrix({4, 300}, .5, 1), find_codec("rows-fast-bits"));
  container.ones = 3;
  const auto file = write_container(container);
  const RowReader reader(file);
  std::vector<std::uint64_t> words(5);
  RowScratch scratch;
  EXPECT_THROW(reader.bits(0, words, scratch), FormatError);
}

}  // namespace
}  // namespace vismat
