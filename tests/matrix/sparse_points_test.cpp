// Tests points in memory against the matrix, and points on disk against those in memory.
#include "matrix/points/sparse_points.h"

#include <gtest/gtest.h>

#include <stdexcept>

#include "layout/cost.h"
#include "layout/orders/random_order.h"
#include "matrix/points/column_points.h"
#include "tests/codecs/matrices.h"
#include "tests/matrix/temporary_folder.h"

namespace vismat {
namespace {

TEST(SparsePoints, DistancesAreThoseOfTheBitVectors) {
  for (const auto& m : test::assorted_matrices()) {
    const ColumnPoints dense(m.matrix);
    const SparsePoints sparse(m.matrix, false);
    ASSERT_EQ(sparse.size(), dense.size()) << m.name;
    Random random(1);
    for (int trial = 0; trial < 200; ++trial) {
      const std::uint32_t a = random.below(dense.size() + 1), b = random.below(dense.size() + 1);
      EXPECT_EQ(sparse.distance(a, b), dense.distance(a, b)) << m.name;
    }
  }
}

TEST(SparsePoints, CollapseEqualColumnsAndDropEmptyOnes) {
  const auto m = VisibilityMatrix::from_rows({{0, 2, 5}, {0, 2}, {4, 5}}, 7);  // 0 = 2; 1, 3 and 6 are empty
  const SparsePoints points(m);
  ASSERT_EQ(points.size(), 3u);
  EXPECT_EQ(points.column(0), 0u);
  EXPECT_EQ(points.column(1), 4u);
  EXPECT_EQ(points.column(2), 5u);
  const std::uint32_t visits[] = {1, 0, 2};
  EXPECT_EQ(points.order_of_columns(visits).old_of_new(), (std::vector<std::uint32_t>{4, 0, 2, 5, 1, 3, 6}));
}

TEST(SparsePoints, RunsAreThoseOfTheReorderedMatrix) {
  for (const auto& m : test::assorted_matrices()) {
    for (const bool collapse : {false, true}) {
      const SparsePoints points(m.matrix, collapse);
      std::vector<std::uint32_t> visits(points.size());
      for (std::uint32_t p = 0; p < points.size(); ++p) visits[p] = points.size() - 1 - p;
      const auto reordered =
          permute(m.matrix, Permutation::identity(m.matrix.shape().rows), points.order_of_columns(visits));
      EXPECT_EQ(runs_of_visits(points, visits), count_runs(reordered)) << m.name;
    }
  }
}

TEST(SparsePoints, OutOfCoreAreTheSame) {
  const TemporaryFolder folder;
  for (const auto& m : test::assorted_matrices()) {
    const SparsePoints in_memory(m.matrix);
    for (const std::uint64_t buffer_bytes : {0u, 40u, 1u << 20}) {
      SparsePoints made(m.matrix, folder / "", buffer_bytes);
      const SparsePoints on_disk = std::move(made);
      ASSERT_EQ(on_disk.size(), in_memory.size()) << m.name;
      EXPECT_EQ(on_disk.rows(), in_memory.rows());
      for (std::uint32_t p = 0; p <= in_memory.size(); ++p) {
        const auto a = on_disk.ones(p), b = in_memory.ones(p);
        EXPECT_TRUE(std::equal(a.begin(), a.end(), b.begin(), b.end())) << m.name;
      }
    }
  }
  EXPECT_EQ(folder.entries(), 0u);
}

TEST(SparsePoints, NameTheFolderThatCannotBeWritten) {
  try {
    const SparsePoints points(VisibilityMatrix::from_rows({{0}}, 1), "/no/such/folder", 1000);
    FAIL() << "made";
  } catch (const std::runtime_error& error) {
    EXPECT_EQ(std::string(error.what()),
              "/no/such/folder: no temporary file to be had: No such file or directory");
  }
}

TEST(SparsePoints, VisitsAndOrdersAreInverse) {
  for (const auto& m : test::assorted_matrices()) {
    const SparsePoints points(m.matrix);
    const auto visits = points.visits_of_order(random_order(m.matrix.shape().columns, 3));
    EXPECT_EQ(points.visits_of_order(points.order_of_columns(visits)), visits) << m.name;
    EXPECT_EQ(visits.size(), points.size()) << m.name;
  }
}

}  // namespace
}  // namespace vismat
