#include "matrix/files/matrix_market.h"

#include <gtest/gtest.h>

#include <sstream>
#include <string>

#include "matrix/base/byte_reader.h"
#include "matrix/base/random.h"
#include "matrix/files/text.h"

namespace vismat {
namespace {

Dataset read(const std::string& text) {
  std::string room;
  return read_matrix_market(as_utf8(std::as_bytes(std::span(text)), room));
}

MatrixNotes notes_of(const std::string& text) {
  MatrixNotes notes;
  read_matrix_market(text, &notes);
  return notes;
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
      read("%%MatrixMarket matrix coordinate real general\n1 4 4\n1 1 1e-400\n1 2 0.0e5\n1 3 7.\n1 4 .5\n")
          .matrix,
      VisibilityMatrix::from_rows({{0, 2, 3}}, 4));
  EXPECT_EQ(
      read("%%MatrixMarket matrix coordinate complex general\n1 3 3\n1 1 0 1\n1 2 0 0\n1 3 1 0\n").matrix,
      VisibilityMatrix::from_rows({{0, 2}}, 3));
}

TEST(MatrixMarket, TakesExponentsOfFortran) {
  const auto row = VisibilityMatrix::from_rows({{0, 2, 4, 6, 7}}, 8);
  EXPECT_EQ(read("%%MatrixMarket matrix coordinate double general\n1 8 8\n1 1 1.0D+00\n1 2 0.0d0\n1 3 -1+02\n"
                 "1 4 0.000-300\n1 5 1.5-300\n1 6 0q3\n1 7 1E2\n1 8 +.5e-1\n")
                .matrix,
            row);
}

TEST(MatrixMarket, TakesEachFieldAndEitherForm) {
  for (const std::string field : {"integer", "unsigned-integer", "real", "double", "Unsigned-Integer"}) {
    EXPECT_EQ(read("%%MatrixMarket matrix coordinate " + field + " general\n2 2 2\n1 2 1\n2 1 3\n").matrix,
              VisibilityMatrix::from_rows({{1}, {0}}, 2));
    EXPECT_EQ(
        read("%%MatrixMarket matrix array " + field + " general\n%\n2 3\n1\n0\n0 % c\n%c\n2 0\n\n4").matrix,
        VisibilityMatrix::from_rows({{0}, {1, 2}}, 3));
  }
  EXPECT_EQ(read("%%MatrixMarket matrix array complex general\n1 3\n0 0\n0 1\n1 0\n").matrix,
            VisibilityMatrix::from_rows({{1, 2}}, 3));
  const std::string array = "%%MatrixMarket matrix array real ";
  for (const std::string symmetry : {"symmetric", "hermitian"}) {
    EXPECT_EQ(read(array + symmetry + "\n3 3\n1\n2\n0\n0\n4\n5\n").matrix,
              VisibilityMatrix::from_rows({{0, 1}, {0, 2}, {1, 2}}, 3));
  }
  EXPECT_EQ(read(array + "skew-symmetric\n3 3\n2\n0\n4\n").matrix,
            VisibilityMatrix::from_rows({{1}, {0, 2}, {1}}, 3));
  EXPECT_EQ(
      read("%%MatrixMarket matrix array complex skew-symmetric\n2 2\n0 0\n0 4\n0 0\n").matrix,  // as SciPy
      VisibilityMatrix::from_rows({{1}, {0}}, 2));
  EXPECT_EQ(read(array + "general\n0 5\n").matrix, VisibilityMatrix({0, 5}));
}

TEST(MatrixMarket, TakesTextOfOtherSystems) {
  const std::string text = pattern + "3 4 5\n1 2\n1 4\n\n3 1\n%c\n3 2\n3 3\n";
  const auto with = [&](const std::string& line_end) {
    std::string other;
    for (const char c : text) other += c == '\n' ? line_end : std::string(1, c);
    return other;
  };
  for (const std::string line_end : {"\n", "\r\n", "\r"}) EXPECT_EQ(read(with(line_end)).matrix, example);
  EXPECT_EQ(read("\xef\xbb\xbf" + text).matrix, example);
  EXPECT_EQ(read("\n\n" + text).matrix, example);
  EXPECT_EQ(read(text + "\x1a").matrix, example);
  EXPECT_EQ(read(text.substr(0, text.size() - 1) + "\x1a\x1a" + "9 9 9").matrix, example);
  for (const bool big : {false, true}) {
    for (const bool mark : {false, true}) {
      std::string wide = !mark ? "" : big ? "\xfe\xff" : "\xff\xfe";
      for (const char c : text) wide += big ? std::string{'\0', c} : std::string{c, '\0'};
      EXPECT_EQ(read(wide).matrix, example);
      EXPECT_THROW(read(wide + "x"), FormatError);
    }
  }
  std::string room;
  const std::string units("\xff\xfe%\0\xe9\0\xac\x20\x3d\xd8\0\xde", 12);
  EXPECT_EQ(as_utf8(std::as_bytes(std::span(units)), room), "%\xc3\xa9\xe2\x82\xac\xf0\x9f\x98\x80");
}

TEST(MatrixMarket, MergesRepeatedEntriesAndCountsThem) {
  const std::string twice = pattern + "3 4 6\n3 3\n1 2\n3 1\n1 2\n3 3\n3 3\n";
  EXPECT_EQ(read(twice).matrix, VisibilityMatrix::from_rows({{1}, {}, {0, 2}}, 4));
  EXPECT_EQ(notes_of(twice), (MatrixNotes{3, 0, 0}));
  EXPECT_EQ(notes_of("%%MatrixMarket matrix coordinate real general\n2 2 2\n1 1 0\n1 1 1\n"),
            (MatrixNotes{0, 0, 1}));
  EXPECT_EQ(notes_of(pattern + "3 4 1\n3 3\n").text(), "");
  EXPECT_EQ((MatrixNotes{1, 2, 3}).text(),
            "1 repeated entry merged, 2 entries mirrored, 3 entries of value zero left out");
}

TEST(MatrixMarket, ExpandsSymmetryOfEitherTriangle) {
  const auto half = VisibilityMatrix::from_rows({{1, 2}, {0}, {0, 2}}, 3);
  for (const std::string symmetry : {"symmetric", "skew-symmetric", "hermitian"}) {
    const std::string begin = "%%MatrixMarket matrix coordinate pattern " + symmetry + "\n3 3 ";
    EXPECT_EQ(read(begin + "3\n1 2\n1 3\n3 3\n").matrix, half);
    EXPECT_EQ(notes_of(begin + "3\n1 2\n1 3\n3 3\n"), (MatrixNotes{0, 2, 0}));
    EXPECT_EQ(read(begin + "4\n1 2\n2 1\n3 1\n3 3\n").matrix, half);
    EXPECT_EQ(notes_of(begin + "4\n1 2\n2 1\n3 1\n3 3\n"), (MatrixNotes{1, 2, 0}));
  }
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
  refused("line 1: says 'vector coordinate'", "%%MatrixMarket vector coordinate real general\n1 1\n1\n");
  refused("line 1: the field must be integer,", "%%MatrixMarket matrix array pattern general\n1 1\n1\n");
  refused("promises 16000000000000000000 values",
          "%%MatrixMarket matrix array real general\n4000000000 4000000000\n");
  refused("promises 18446744073709551615 values",
          "%%MatrixMarket matrix array real general\n40000000000 40000000000\n");
  refused("needs 4 values, but has 3", "%%MatrixMarket matrix array real general\n2 2\n1 1 1\n");
  refused("line 4: has more than the 1 values", "%%MatrixMarket matrix array real general\n1 1\n1\n1\n");
  refused("line 1: the field", "%%MatrixMarket matrix coordinate quaternion general\n1 1 0\n");
  refused("line 1: the symmetry", "%%MatrixMarket matrix coordinate pattern\n1 1 0\n");
  refused("line 1: symmetry needs", "%%MatrixMarket matrix coordinate pattern symmetric\n1 2 0\n");
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
  refused("line 3: the column is not a whole number: '2.0'", pattern + "3 4 1\n1 2.0\n");
  for (const std::string word : {"zero", "nan", "NaN", "inf", "-inf", "1.#INF", "-1.#IND00", "1.#QNAN", "1e",
                                 "1d+", "1+", "1,5", "0x1", "1..2", ".", "-", "1e5.0", "--1"}) {
    const std::string begin = "%%MatrixMarket matrix coordinate real general\n1 1 1\n1 1 ";
    refused("line 3: the value '" + word + "' is not a number", begin + word + "\n");
  }
  refused("line 3: the value is missing", "%%MatrixMarket matrix coordinate complex general\n1 1 1\n1 1 1\n");
  refused("line 2: guarantee", pattern + "%%vismat guarantee: firm\n1 1 0\n");
  refused("line 2: the seed", pattern + "%%vismat seed: -1\n1 1 0\n");
}

}  // namespace
}  // namespace vismat
