#include "matrix/files/matrix_market.h"

#include <gtest/gtest.h>

#include <sstream>
#include <string>

#include "matrix/base/byte_reader.h"
#include "matrix/base/random.h"

namespace vismat {
namespace {

Dataset read(const std::string& text) {
  return read_matrix_market(std::as_bytes(std::span(text)));
}

std::string written(const Dataset& dataset) {
  std::ostringstream out;
  write_matrix_market(out, dataset);
  return out.str();
}

const std::string pattern = "%%MatrixMarket matrix coordinate pattern general\n";
const auto example = VisibilityMatrix::from_rows({{1, 3}, {}, {0, 1, 2}}, 4);

TEST(MatrixMarket, TakesAnyOrderSpaceAndComment) {
  EXPECT_EQ(read(pattern + "3 4 5\n1 2\n1 4\n3 1\n3 2\n3 3\n").matrix, example);
  EXPECT_EQ(read(pattern + "% a comment\n\n3\t4  5 \n3 3\n  1 4\n\n%more\n3 1\r\n1 2 \t\n3 2").matrix,
            example);
  EXPECT_EQ(
      read(
          "%%matrixmarket MATRIX Coordinate  pattern GENERAL\r\n3 4 5\r\n1 2\r\n1 4\r\n3 1\r\n3 2\r\n3 3\r\n")
          .matrix,
      example);
  EXPECT_EQ(read(pattern + "0 0 0").matrix, VisibilityMatrix({0, 0}));
  EXPECT_EQ(read(pattern + "2 3 0\n").matrix, VisibilityMatrix({2, 3}));
}

TEST(MatrixMarket, TakesValuesAndDropsZeros) {
  EXPECT_EQ(
      read("%%MatrixMarket matrix coordinate integer general\n1 4 4\n1 1 -7\n1 2 0\n1 3 +1\n1 4 -0\n").matrix,
      VisibilityMatrix::from_rows({{0, 2}}, 4));
  EXPECT_EQ(
      read("%%MatrixMarket matrix coordinate real general\n1 4 4\n1 1 1e-400\n1 2 0.0e5\n1 3 nan\n1 4 .5\n")
          .matrix,
      VisibilityMatrix::from_rows({{0, 2, 3}}, 4));
  EXPECT_EQ(
      read("%%MatrixMarket matrix coordinate complex general\n1 3 3\n1 1 0 1\n1 2 0 0\n1 3 1 0\n").matrix,
      VisibilityMatrix::from_rows({{0, 2}}, 3));
}

TEST(MatrixMarket, ExpandsSymmetry) {
  const auto whole = VisibilityMatrix::from_rows({{0, 1, 2}, {0}, {0, 2}}, 3);
  EXPECT_EQ(read("%%MatrixMarket matrix coordinate pattern symmetric\n3 3 4\n1 1\n2 1\n3 1\n3 3\n").matrix,
            whole);
}

TEST(MatrixMarket, KeepsTheFacts) {
  Dataset dataset;
  dataset.matrix = example;
  dataset.provenance = "a: file\nof two lines";
  dataset.guarantee = Guarantee::conservative;
  dataset.seed = ~std::uint64_t{0};
  dataset.rows_are = "portal";
  dataset.columns_are = "";
  Dataset back = read(written(dataset));
  EXPECT_EQ(back.provenance, "a: file of two lines");
  back.provenance = dataset.provenance;
  EXPECT_EQ(back, dataset);
}

TEST(MatrixMarket, RoundTripsAcrossItsBlocks) {
  Random random(1);
  std::vector<std::vector<std::uint32_t>> rows(3000);
  for (auto& row : rows) {
    for (std::uint32_t c = random.below(100); c < 5000; c += 1 + random.below(100))
      row.push_back(c * 400'000);
  }
  Dataset dataset;
  dataset.matrix = VisibilityMatrix::from_rows(rows, 2'000'000'000);
  ASSERT_GT(written(dataset).size(), std::size_t{1} << 20);
  EXPECT_THROW(read(written(dataset)), FormatError);  // two thousand million columns for so few entries
  dataset.matrix = VisibilityMatrix({0, 0});
  EXPECT_EQ(read(written(dataset)), dataset);
  for (auto& row : rows) {
    for (auto& c : row) c /= 400'000;
  }
  dataset.matrix = VisibilityMatrix::from_rows(rows, 5000);
  EXPECT_EQ(read(written(dataset)), dataset);
}

TEST(MatrixMarket, RefusesAndNamesTheLine) {
  const auto refused = [](const std::string& words, const std::string& text) {
    try {
      read(text);
      FAIL() << "taken: " << text;
    } catch (const FormatError& error) {
      EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
    }
  };
  refused("line 1: must begin", "");
  refused("line 1: must begin", "%MatrixMarket matrix coordinate pattern general\n1 1 0\n");
  refused("line 1: only 'matrix coordinate'", "%%MatrixMarket matrix array real general\n1 1\n1\n");
  refused("line 1: the field", "%%MatrixMarket matrix coordinate quaternion general\n1 1 0\n");
  refused("line 1: the symmetry", "%%MatrixMarket matrix coordinate pattern\n1 1 0\n");
  refused("line 1: symmetry needs", "%%MatrixMarket matrix coordinate pattern symmetric\n1 2 0\n");
  refused("line 3: lies above", "%%MatrixMarket matrix coordinate pattern symmetric\n2 2 1\n1 2\n");
  refused("ends before the line", pattern);
  refused("line 2: the number of entries", pattern + "3 4\n");
  refused("line 2: the number of rows is larger", pattern + "18446744073709551616 4 0\n");
  refused("4294967296 columns", pattern + "3 4294967296 0\n");
  refused("claims 4294967295 rows", pattern + "4294967295 3 0\n");
  refused("promises 4000000000 entries, but only", pattern + "3 4 4000000000\n1 1\n");
  refused("promises 18446744073709551615 entries", pattern + "3 4 18446744073709551615\n1 1\n");
  refused("ends after 2", pattern + "3 4 3\n1 1\n1 2\n");
  refused("line 5: is one more than the 2", pattern + "3 4 2\n1 1\n1 2\n1 3\n");
  refused("line 4: entry 0 1", pattern + "3 4 2\n1 1\n0 1\n");
  refused("line 4: entry 1 5", pattern + "3 4 2\n1 1\n1 5\n");
  refused("line 3: the row", pattern + "3 4 1\n-1 1\n");
  refused("line 3: the column", pattern + "3 4 1\n1\n");
  refused("line 3: the column", pattern + "3 4 1\n1 2x\n");
  refused("line 3: has more", pattern + "3 4 1\n1 2 3\n");
  refused("entry 2 3 is there twice", pattern + "3 4 3\n2 3\n1 1\n2 3\n");
  refused("line 3: the value", "%%MatrixMarket matrix coordinate real general\n1 1 1\n1 1 zero\n");
  refused("line 2: guarantee", pattern + "%%vismat guarantee: firm\n1 1 0\n");
  refused("line 2: the seed", pattern + "%%vismat seed: -1\n1 1 0\n");
}

}  // namespace
}  // namespace vismat
