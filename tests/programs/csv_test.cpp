// Tests the text of tables: values, lines, quotes, and tables that grow.
#include "programs/csv.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <string>
#include <string_view>

#include "matrix/base/atomic_file.h"
#include "tests/matrix/temporary_folder.h"

namespace vismat {
namespace {

TEST(Csv, NumbersAndTextAsTheyAre) {
  EXPECT_EQ(csv_line("a", std::string("b c"), std::string_view("d"), ""), "a,b c,d,\n");
  EXPECT_EQ(csv_line(1, -2, std::numeric_limits<std::uint64_t>::max(), true, false),
            "1,-2,18446744073709551615,1,0\n");
  EXPECT_EQ(csv_line(.5, 2., 1. / 3, 1e-7, 123456789012.), "0.5,2,0.333333333333,1e-07,123456789012\n");
  EXPECT_EQ(csv_values(1, "x"), "1,x");
}

TEST(Csv, QuotesTextWithCommas) {
  EXPECT_EQ(csv_quoted("a, b"), "\"a, b\"");
  EXPECT_EQ(csv_quoted("5\" wide"), "\"5\"\" wide\"");
}

TEST(Csv, TablesGrowOnlyWhereTold) {
  const TemporaryFolder folder;
  const std::string file = folder / "table.csv";
  EXPECT_EQ(table_begin(file, "x\n", true), "x\n");
  write_table(file, "x\n1\n");
  EXPECT_EQ(table_begin(file, "x\n", true), "x\n1\n");
  EXPECT_EQ(table_begin(file, "x\n", false), "x\n");
  write_table("", "goes nowhere");
}

}  // namespace
}  // namespace vismat
