// The order by FLANN's neighbours. FLANN seeds itself from the system, so nothing here expects the same result twice:
// what is tested holds for every result. Each of FLANN's known traps is pinned in FLANN itself (FlannTrap), so that the
// day it is mended shows, and shown not to be walked into (FlannTour, FlannNeighbours).
#include "layout/tours/flann_tour.h"

#if defined(FLANN_HPP_) || __has_include(<mpi.h>) || __has_include(<H5public.h>)
#error "layout's headers and flags show nothing of FLANN, nor of the MPI and HDF5 its package brings along"
#endif

#include <gtest/gtest.h>

#include <algorithm>
#include <flann/flann.hpp>
#include <numeric>
#include <set>
#include <stdexcept>
#include <tuple>

#include "layout/cost.h"
#include "layout/orders/random_order.h"
#include "tests/codecs/matrices.h"

namespace vismat {
namespace {

using Hamming = flann::Hamming<unsigned char>;
using Bytes = flann::Matrix<unsigned char>;

// Columns around a few random ones, each with some bits changed; columns differ.
VisibilityMatrix planted_clusters(Shape shape, std::uint32_t clusters, double density, std::uint32_t changes,
                                  std::uint64_t seed) {
  const BitRows centres(test::random_matrix({clusters, shape.rows}, density, seed));
  BitRows columns({shape.columns, shape.rows});
  Random random(seed, 1);
  for (std::uint32_t c = 0; c < shape.columns; ++c) {
    std::ranges::copy(centres.row(random.below(clusters)), columns.row(c).begin());
    for (std::uint32_t i = 0; i < changes; ++i) {
      const std::uint32_t r = random.below(shape.rows);
      columns.row(c)[r / 64] ^= std::uint64_t{1} << (r % 64);
    }
  }
  return transpose(columns.to_matrix());
}

// ---- what FLANN does

TEST(FlannTrap, HammingIgnoresTheLastBytes) {
  const std::uint64_t a[] = {0, 0}, b[] = {0, ~std::uint64_t{0}};
  const auto* pa = reinterpret_cast<const unsigned char*>(a);
  const auto* pb = reinterpret_cast<const unsigned char*>(b);
  EXPECT_EQ(Hamming()(pa, pb, 15), 0u);
  EXPECT_EQ(Hamming()(pa, pb, 16), 64u);
}

struct Queries {
  explicit Queries(const VisibilityMatrix& m)
      : bits(transpose(m)),
        points(reinterpret_cast<unsigned char*>(bits.row(0).data()), m.shape().columns,
               bits.words_per_row() * 8) {}
  BitRows bits;
  Bytes points;
};

TEST(FlannTrap, LshIntoVectorsRepeatsAnId) {
  Queries data(planted_clusters({512, 2000}, 40, .5, 20, 1));
  flann::Index<Hamming> index(data.points, flann::LshIndexParams(8, 10, 1));
  index.buildIndex();
  std::vector<std::vector<std::size_t>> ids;
  std::vector<std::vector<unsigned>> distances;
  index.knnSearch(data.points, ids, distances, 5, flann::SearchParams(64));
  int repeated = 0;
  for (const auto& list : ids) repeated += std::set(list.begin(), list.end()).size() < list.size();
  EXPECT_GT(repeated, 1900);

  std::vector<std::size_t> flat(5 * 2000);
  std::vector<unsigned> flat_distances(5 * 2000);
  flann::Matrix<std::size_t> found(flat.data(), 2000, 5);
  flann::Matrix<unsigned> found_distances(flat_distances.data(), 2000, 5);
  index.knnSearch(data.points, found, found_distances, 5, flann::SearchParams(64));
  for (std::size_t q = 0; q < 2000; ++q) {
    EXPECT_EQ(std::set(found[q], found[q] + 5).size(), 5u);
  }
}

// Nearly all columns have the key zero, so that nearly all are looked at, in each table anew.
TEST(FlannTrap, LshKeysOfSparseColumnsAreNearlyAllZero) {
  for (const auto& [density, least, most] : {std::tuple(.01, 1400u, 2000u), std::tuple(.5, 0u, 100u)}) {
    Queries data(test::random_matrix({1024, 2000}, density, 3));
    flann::lsh::LshTable<unsigned char> table(static_cast<unsigned>(data.points.cols), 20);
    std::vector<std::pair<std::size_t, unsigned char*>> members;
    for (std::size_t c = 0; c < 2000; ++c) members.emplace_back(c, data.points[c]);
    table.add(members);
    const flann::lsh::Bucket* zero = table.getBucketFromKey(0);
    const std::size_t with_key_zero = zero == nullptr ? 0 : zero->size();
    EXPECT_GE(with_key_zero, least) << density;
    EXPECT_LE(with_key_zero, most) << density;
  }
}

// Of 500 queries, those whose nearest is found.
int found_with_checks(int checks) {
  Queries data(planted_clusters({512, 3000}, 60, .3, 40, 5));
  flann::HierarchicalClusteringIndex<Hamming> index(data.points, flann::HierarchicalClusteringIndexParams());
  index.buildIndex();
  std::vector<std::size_t> ids(2 * 500);
  std::vector<unsigned> distances(2 * 500);
  flann::Matrix<std::size_t> found(ids.data(), 500, 2);
  flann::Matrix<unsigned> found_distances(distances.data(), 500, 2);
  index.knnSearch(Bytes(data.points.ptr(), 500, data.points.cols), found, found_distances, 2,
                  flann::SearchParams(checks));
  int right = 0;
  for (std::uint32_t q = 0; q < 500; ++q) {
    std::uint32_t nearest = 0xffffffff;
    for (std::uint32_t p = 0; p < 3000; ++p) {
      if (p != q) nearest = std::min(nearest, hamming_distance(data.bits.row(q), data.bits.row(p), nearest));
    }
    right += found_distances[q][1] == nearest;
  }
  return right;
}

TEST(FlannTrap, UnlimitedChecksFindLessThanManyChecks) {
  EXPECT_LT(found_with_checks(flann::FLANN_CHECKS_UNLIMITED), 450);
  EXPECT_EQ(found_with_checks(1'000'000), 500);
}

// ---- what we make of it

TEST(FlannNeighbours, AreDistinctOthersWithExactDistancesNearestFirst) {
  const auto m = planted_clusters({300, 1500}, 30, .3, 20, 7);
  const ColumnPoints points(m);
  const NeighbourLists lists = flann_neighbours(m, points, {}, 2);
  const NeighbourLists exact = exact_neighbours(points, 10);
  ASSERT_EQ(lists.per_point, 10u);
  ASSERT_EQ(lists.ids.size(), 1501u * 10);
  std::size_t as_near = 0;
  for (std::uint32_t p = 0; p < 1501; ++p) {
    const auto first = lists.ids.begin() + p * 10;
    EXPECT_EQ(std::set(first, first + 10).size(), 10u);
    for (std::uint32_t i = p * 10; i < p * 10 + 10; ++i) {
      EXPECT_NE(lists.ids[i], p);
      ASSERT_LE(lists.ids[i], 1500u);
      EXPECT_EQ(lists.distances[i], points.distance(p, lists.ids[i]));
      EXPECT_TRUE(i == p * 10 || lists.distances[i - 1] <= lists.distances[i]);
      EXPECT_GE(lists.distances[i], exact.distances[i]);
      as_near += lists.distances[i] == exact.distances[i];
    }
  }
  EXPECT_GT(as_near, 1501u * 10 * 8 / 10);
}

// All that tells columns apart lies beyond the last whole eight bytes.
TEST(FlannNeighbours, SeeTheLastRows) {
  BitRows columns({400, 70});
  for (std::uint32_t c = 0; c < 400; ++c) {
    columns.set(c, c % 64);
    for (std::uint32_t bit = 0; bit < 6; ++bit) {
      if (c * 31 % 64 >> bit & 1) columns.set(c, 64 + bit);
    }
  }
  const auto m = transpose(columns.to_matrix());
  const ColumnPoints points(m);
  const NeighbourLists lists = flann_neighbours(m, points, {.neighbours = 1, .checks = 100000});
  EXPECT_EQ(lists.distances, exact_neighbours(points, 1).distances);
}

TEST(FlannNeighbours, AreAllTheOthersWhereThereAreFew) {
  const auto m = test::random_matrix({40, 300}, .3, 2);
  const ColumnPoints points(m);
  EXPECT_EQ(flann_neighbours(m, points, {.neighbours = 1000}).per_point, 300u);
  const VisibilityMatrix one = VisibilityMatrix::from_rows({{0}}, 1);
  EXPECT_EQ(flann_neighbours(one, ColumnPoints(one)).per_point, 1u);
}

// FLANN forgets branches once as many wait as there are points; with many deep trees it then finds less than asked for.
TEST(FlannNeighbours, AreFullWhereFlannForgets) {
  const auto m = test::random_matrix({40, 60}, .3, 6);
  const ColumnPoints points(m);
  const NeighbourLists lists =
      flann_neighbours(m, points, {.neighbours = 60, .trees = 100, .branching = 2, .leaf_points = 1});
  EXPECT_EQ(lists.distances, exact_neighbours(points, 60).distances);
}

TEST(FlannNeighbours, OfColumnsWithoutRows) {
  const VisibilityMatrix m(Shape{0, 500});
  const NeighbourLists lists = flann_neighbours(m, ColumnPoints(m));
  EXPECT_EQ(lists.distances, std::vector<std::uint32_t>(501 * 10, 0));
}

TEST(FlannNeighbours, RefuseUnlimitedChecksAndOtherNonsense) {
  const auto m = test::random_matrix({10, 10}, .3, 2);
  const ColumnPoints points(m);
  const auto unlimited = static_cast<std::uint32_t>(flann::FLANN_CHECKS_UNLIMITED);
  EXPECT_THROW(flann_neighbours(m, points, {.checks = unlimited}), std::invalid_argument);
  EXPECT_THROW(flann_neighbours(m, points, {.checks = 0}), std::invalid_argument);
  EXPECT_THROW(flann_neighbours(m, points, {.branching = 1}), std::invalid_argument);
  EXPECT_THROW(flann_neighbours(m, points, {.trees = 0}), std::invalid_argument);
  EXPECT_THROW(flann_neighbours(m, points, {.neighbours = 0}), std::invalid_argument);
}

TEST(FlannTour, IsABijectionOfEveryMatrix) {
  for (const auto& m : test::assorted_matrices()) {
    for (const std::uint32_t leaf_points : {1u, 100u}) {  // 1: FLANN also where a list of all would do
      const auto order = order_by_flann_tour(m.matrix, {.leaf_points = leaf_points}, {.kicks_per_point = 1});
      EXPECT_EQ(order.size(), m.matrix.shape().columns) << m.name;
      EXPECT_EQ(permute(permute(m.matrix, Permutation::identity(m.matrix.shape().rows), order),
                        Permutation::identity(m.matrix.shape().rows), order.inverse()),
                m.matrix)
          << m.name;
    }
  }
}

// Identical columns would fill each other's lists, and one leaf.
TEST(FlannTour, KeepsEqualColumnsTogether) {
  const auto kinds = test::random_matrix({60, 150}, .3, 4);
  std::vector<std::vector<std::uint32_t>> rows(60);
  for (std::uint32_t r = 0; r < 60; ++r) {
    for (std::uint32_t copy = 0; copy < 20; ++copy) {
      for (const std::uint32_t c : kinds.row(r)) rows[r].push_back(copy * 150 + c);
    }
  }
  const auto order = order_by_flann_tour(VisibilityMatrix::from_rows(rows, 3000)).old_of_new();
  for (std::uint32_t place = 0; place < 3000; ++place) {
    EXPECT_EQ(order[place] % 150, order[place - place % 20] % 150);
    EXPECT_EQ(order[place] / 150, place % 20);
  }
}

TEST(FlannTour, BringsAPlantedOrderBack) {
  std::vector<std::vector<std::uint32_t>> rows(630);
  const Permutation shuffle = random_order(600, 5);
  for (std::uint32_t c = 0; c < 600; ++c) {
    for (std::uint32_t r = c; r < c + 30; ++r) rows[r].push_back(shuffle.new_of_old()[c]);
  }
  for (auto& row : rows) std::ranges::sort(row);
  const auto m = VisibilityMatrix::from_rows(rows, 600);
  ASSERT_EQ(count_runs(m, shuffle.inverse()), 629u);
  EXPECT_LE(count_runs(m, order_by_flann_tour(m)), 629u * 12 / 10);
}

}  // namespace
}  // namespace vismat
