// Rows that depend on rows, shared sections, bands and boxes, by codecs that need them; and what prepared_for does for each need.
#include "tests/codecs/toy_codecs.h"

#include <gtest/gtest.h>

#include <array>

#include "codecs/vmat/checked_bytes.h"
#include "codecs/vmat/container.h"
#include "codecs/vmat/row_reader.h"
#include "programs/prepared_for.h"
#include "tests/codecs/matrices.h"

namespace vismat {
namespace {

using test::row_differences;
using test::rows_under_boxes;

TEST(RowsThatDependOnRows, RoundTripWholeAndAlone) {
  const Codec& codec = row_differences();
  for (const auto& [name, matrix] : test::assorted_matrices()) {
    const auto file = write_container(compress(matrix, codec));
    const Container container = read_container(file);
    EXPECT_EQ(decompress(container, codec), matrix) << name;
    EXPECT_EQ(container.encoded.bands.size(), (matrix.shape().rows + 7) / 8) << name;
    const RowReader reader(file, std::span(&codec, 1));
    RowBuffer<std::uint32_t> ids;
    std::vector<std::uint64_t> bits((matrix.shape().columns + 63) / 64);
    for (std::uint32_t r = matrix.shape().rows; r-- > 0;) {
      EXPECT_TRUE(std::ranges::equal(reader.ids(r, ids), matrix.row(r))) << name << ", row " << r;
      reader.bits(r, bits, ids);
      EXPECT_EQ(reader.cost(r).parts, r % 8 + 1) << name;
    }
  }
}

// A part that a row depends on is checked, another's is not looked at.
TEST(RowsThatDependOnRows, AskForCheckedPartsAlone) {
  const Codec& codec = row_differences();
  const auto matrix = test::random_matrix({16, 100000}, .15, 1);
  const auto good = write_container(compress(matrix, codec));
  const ContainerHead head(good);
  const auto payload = head.section(vmat::Section::payload);
  const Container container = read_container(good);
  ASSERT_FALSE(container.encoded.shared.empty());
  const Parts parts(container.encoded);
  RowBuffer<std::uint32_t> ids;
  for (const std::uint32_t damaged : {0u, 9u, 12u, 15u}) {
    ASSERT_GT(parts.part_bytes(damaged), 2 * CheckedBytes::block_bytes);
    auto file = good;
    std::uint64_t at = static_cast<std::uint64_t>(payload.data() - good.data());
    for (std::uint32_t r = 0; r < damaged; ++r) at += parts.part_bytes(r);
    file[at + parts.part_bytes(damaged) / 2] ^= std::byte{1};
    const RowReader reader(file, std::span(&codec, 1));
    for (std::uint32_t r = 0; r < 16; ++r) {
      if (r / 8 == damaged / 8 && r >= damaged)
        EXPECT_THROW(reader.ids(r, ids), FormatError) << r;
      else
        EXPECT_TRUE(std::ranges::equal(reader.ids(r, ids), matrix.row(r)))
            << r << " with " << damaged << " damaged";
    }
  }
  auto file = good;
  file[file.size() - 1] ^= std::byte{1};  // of the shared section, the last
  EXPECT_THROW(RowReader(file, std::span(&codec, 1)).ids(3, ids), FormatError);
}

TEST(RowsThatDependOnRows, SurviveDamage) {
  const Codec& codec = row_differences();
  const auto matrix = test::clustered_matrix({40, 50}, 6);
  const Encoded good = codec.encode(matrix, {}, {});
  ASSERT_FALSE(good.shared.empty());
  const auto tried = [&](const Encoded& bad) {
    try {
      EXPECT_EQ(decode(codec, bad, matrix.shape()).shape(), matrix.shape());
    } catch (const FormatError&) {
    }
  };
  for (std::size_t bit = 0; bit < 8 * good.payload.size(); ++bit) {
    Encoded bad = good;
    bad.payload[bit / 8] ^= std::byte{1} << (bit % 8);
    tried(bad);
  }
  Encoded bad = good;
  bad.bands.clear();
  EXPECT_THROW(decode(codec, bad, matrix.shape()), FormatError);
}

// Rows and columns on a line, each row sees what touches it, but for one entry.
Dataset on_a_line() {
  Dataset data;
  std::vector<std::vector<std::uint32_t>> rows;
  for (std::uint32_t r = 0; r < 30; ++r) {
    const float x = static_cast<float>(r);
    data.row_bounds.push_back({{x, 0, 0}, {x + 2.5f, 1, 1}});
    data.column_bounds.push_back({{x + .25f, 0, 0}, {x + .5f, 1, 1}});
    rows.push_back({r});
    for (std::uint32_t c = r + 1; c < 30 && c <= r + 2; ++c) rows[r].push_back(c);
  }
  rows[7].insert(rows[7].begin(), 0u);
  data.matrix = VisibilityMatrix::from_rows(rows, 30);
  return data;
}

TEST(Boxes, AreWhatAPayloadIsCodedUnder) {
  const Codec& codec = rows_under_boxes();
  Dataset data = on_a_line();
  const Container container = compress(prepared_for(codec, data), codec);
  EXPECT_LT(container.encoded.payload.size(), 4u);
  const auto file = write_container(container);
  const Side boxes = side_of(codec, data);
  EXPECT_EQ(decompress(read_container(file), codec, boxes), data.matrix);
  RowBuffer<std::uint32_t> ids;
  const RowReader reader(file, std::span(&codec, 1), boxes);
  for (std::uint32_t r = 0; r < 30; ++r)
    EXPECT_TRUE(std::ranges::equal(reader.ids(r, ids), data.matrix.row(r))) << r;

  const auto refused = [&](const Side& others, const std::string& why) {
    const auto says = [&](const auto& work) {
      try {
        work();
        ADD_FAILURE() << why;
      } catch (const FormatError& error) {
        EXPECT_NE(std::string(error.what()).find(why), std::string::npos) << error.what();
      }
    };
    says([&] { decompress(read_container(file), codec, others); });
    says([&] { RowReader(file, std::span(&codec, 1), others); });
  };
  refused({}, "they must be given");
  Dataset moved = data;
  moved.column_bounds[29].high[2] = 1.5f;
  refused(side_of(codec, moved), "under other boxes");
  std::swap(moved.row_bounds, moved.column_bounds);
  refused(side_of(codec, moved), "under other boxes");
  // A file that tells no boxes, or others in number, is not decoded under those given.
  Container none = read_container(file);
  none.boxes.reset();
  EXPECT_THROW(decompress(none, codec, boxes), FormatError);
  const auto without = write_container(none);
  EXPECT_THROW(RowReader(without, std::span(&codec, 1), boxes), FormatError);
  Dataset fewer = data;
  fewer.row_bounds.resize(1);
  Container claims = read_container(file);
  claims.boxes = box_sums(side_of(codec, fewer));
  EXPECT_THROW(decompress(claims, codec, side_of(codec, fewer)), FormatError);
  EXPECT_THROW(compress(data.matrix, codec, {}, {}, side_of(codec, fewer)), std::invalid_argument);
  data.row_bounds.clear();
  EXPECT_NE(obstacle(codec, data), "");
  EXPECT_THROW(prepared_for(codec, data), std::invalid_argument);
}

Codec needing(Needs needs) {
  Codec codec = row_differences();
  codec.needs = needs;
  return codec;
}

// Pairs of equal rows and columns, shuffled.
Dataset shuffled_pairs() {
  Dataset data;
  const auto half = test::banded_matrix(40, 9, 7);
  std::vector<std::vector<std::uint32_t>> rows;
  for (std::uint32_t r = 0; r < 40; ++r) {
    std::vector<std::uint32_t> row;
    for (const std::uint32_t c : half.row(r * 13 % 40)) row.insert(row.end(), {2 * c, 2 * c + 1});
    rows.insert(rows.end(), 2, row);
  }
  data.matrix = VisibilityMatrix::from_rows(rows, 80);
  data.guarantee = Guarantee::exact;
  return data;
}

TEST(PreparedFor, DoesWhatIsNeededAndSaysSoInTheSourceMap) {
  const Dataset data = shuffled_pairs();
  const auto prepared = [&](Needs needs) { return prepared_for(needing(needs), data); };
  EXPECT_EQ(prepared({}), data);

  const Dataset rows = prepared({.row_order = true});
  EXPECT_TRUE(rows.source.row_order && !rows.source.column_order);
  const Dataset columns = prepared({.column_order = true});
  EXPECT_TRUE(columns.source.column_order && !columns.source.row_order);
  const Dataset shared = prepared({.row_order = true, .column_order = true, .shared_order = true});
  EXPECT_TRUE(shared.source.row_order);
  EXPECT_EQ(shared.source.row_order, shared.source.column_order);
  const Dataset distinct = prepared({.distinct = true});
  EXPECT_EQ(distinct.matrix.shape(), (Shape{40, 40}));
  EXPECT_EQ(distinct.guarantee, Guarantee::exact);
  for (const Dataset& done : {rows, columns, shared, distinct,
                              prepared({.row_order = true, .column_order = true, .distinct = true})})
    EXPECT_EQ(in_source_numbers(done).matrix, data.matrix);
  EXPECT_EQ(prepared_for(needing({.row_order = true, .column_order = true}), data, {.orders = false}), data);
}

TEST(PreparedFor, MakesNodesAndTreesOrSaysWhatIsMissing) {
  Dataset data = on_a_line();
  const Codec over_rows = needing({.tree = TreeOver::rows}),
              over_columns = needing({.tree = TreeOver::columns, .column_order = true});
  EXPECT_TRUE(prepared_for(over_rows, data).source.row_tree);
  EXPECT_NE(obstacle(over_columns, data), "");
  data.source.tree = test::even_tree(30, 4);
  const Dataset nodes = prepared_for(over_columns, data);
  EXPECT_TRUE(nodes.source.columns_are_nodes && !nodes.source.column_order);
  EXPECT_TRUE(is_monotone(nodes.matrix, *nodes.source.tree));
  data.row_bounds.clear();
  EXPECT_NE(obstacle(over_rows, data), "");
  data.source.row_tree = test::even_tree(30, 2);
  EXPECT_EQ(prepared_for(over_rows, data).source.row_tree, data.source.row_tree);
}

}  // namespace
}  // namespace vismat
