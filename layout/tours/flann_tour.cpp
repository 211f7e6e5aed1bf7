// ALGORITHM. A polished tour on FLANN's neighbours. FLANN's hierarchical clustering [Muja & Lowe 2012] finds near
// columns with a few trees, each split around random columns. A query descends them and continues in the nearest
// branches left until it has examined `checks` columns. The distances are then computed exactly, and the polished tour
// follows.
//
// What FLANN 1.9.2 demands of its caller, each tested: columns in whole 8 bytes (it ignores the rest), distinct columns
// (equal ones pile up in one leaf), a matrix for the results (its LSH repeats an id in vectors), and a finite number of
// checks (with FLANN_CHECKS_UNLIMITED it stops at the first k). Results differ from call to call. It drops branches
// once as many wait as there are points; a list that this left short would be filled up with the next points.
//
// Parameters: FLANN's own trees. Recall of the ten nearest and processor seconds, power plant at 1/64: 1 tree 0.990 in
// 0.44, 4 trees 0.9999 in 0.91, 8 trees 1 in 1.14; parts of 8 0.998 in 0.45. Artificial 2: 256 checks 0.91 in 1.8, 512
// 0.97 in 3.
//
// Measured: the tours equal the polished tour's to 0.06 % either way (artificial 1 and 2, faces of oasago2 and
// ctf_inyard). The lists cost more than all pairs up to some 20,000 columns: 2.7 s to 1.3 s (artificial 2, 5461), 4.6
// to 3.6 (power plant, 12104), 22.4 to 24.1 (24425).
//
// Tried and found worse: a path to the nearest unvisited point instead of greedy edges is 1.1 to 1.7 times as long, and
// after polishing up to 1.2 % longer. LSH (bench flann-recall; 3000 to 10000 columns, 256 to 16384 rows): nearly every
// key is zero, 7 to 120 times the time of a scan; with keys of up to 26 bits, 2 to 23 times at up to 5 % density (0.7
// in 256 rows at 5 %), and recall 0.89 to 0.95 in 0.2 to 0.5 of the time at 20 %. Hierarchical: recall 0.97 to 1 in 0.4
// to 1.4 of the time.
#include "layout/tours/flann_tour.h"

#include <algorithm>
#include <flann/flann.hpp>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "matrix/base/parallel.h"
#include "matrix/bit_rows.h"
#include "matrix/points/distinct_columns.h"

namespace vismat {
namespace {

void check(const FlannOptions& options) {
  constexpr std::uint32_t most = 0x7fffffff;  // FLANN counts in int
  const auto refuse = [](const char* what, std::uint32_t least, std::uint32_t value) {
    if (value < least || value > most) {
      throw std::invalid_argument(std::string("flann: ") + what + " is " + std::to_string(value) +
                                  "; it lies between " + std::to_string(least) + " and " +
                                  std::to_string(most));
    }
  };
  refuse("neighbours", 1, options.neighbours);
  refuse("trees", 1, options.trees);
  refuse("branching", 2, options.branching);
  refuse("leaf_points", 1, options.leaf_points);
  refuse("checks", 1, options.checks);
}

// A column a row in whole words, and the zero point as the last.
BitRows bits_of_points(const VisibilityMatrix& matrix) {
  const Shape shape{matrix.shape().rows, matrix.shape().columns + 1};
  return BitRows(
      transpose(VisibilityMatrix::from_csr(shape, {matrix.offsets().begin(), matrix.offsets().end()},
                                           {matrix.ids().begin(), matrix.ids().end()})));
}

}  // namespace

NeighbourLists flann_neighbours(const VisibilityMatrix& matrix, const ColumnPoints& points,
                                const FlannOptions& options, unsigned threads) {
  check(options);
  const std::uint32_t count = points.size() + 1, k = std::min(options.neighbours, count - 1);
  if (count <= options.leaf_points) return exact_neighbours(points, k, threads);

  BitRows bits = bits_of_points(matrix);
  const std::size_t bytes = bits.words_per_row() * 8;
  const auto rows_from = [&](std::uint32_t first, std::uint32_t rows) {
    return flann::Matrix<unsigned char>(reinterpret_cast<unsigned char*>(bits.row(first).data()), rows,
                                        bytes);
  };
  flann::HierarchicalClusteringIndex<flann::Hamming<unsigned char>> index(
      rows_from(0, count), flann::HierarchicalClusteringIndexParams(
                               static_cast<int>(options.branching), flann::FLANN_CENTERS_RANDOM,
                               static_cast<int>(options.trees), static_cast<int>(options.leaf_points)));
  index.buildIndex();

  NeighbourLists lists{k, std::vector<std::uint32_t>(std::size_t{count} * k),
                       std::vector<std::uint32_t>(std::size_t{count} * k)};
  constexpr std::uint32_t batch = 64;
  parallel_for((count + batch - 1) / batch, threads, [&](std::uint64_t b) {
    const auto first = static_cast<std::uint32_t>(b * batch), queries = std::min(batch, count - first);
    const std::size_t asked = std::size_t{k} + 1;  // a point finds itself
    constexpr std::size_t none = ~std::size_t{0};
    std::vector<std::size_t> ids(queries * asked, none);
    std::vector<unsigned> distances(queries * asked);
    flann::Matrix<std::size_t> found(ids.data(), queries, asked);
    flann::Matrix<unsigned> found_distances(distances.data(), queries, asked);
    index.knnSearch(rows_from(first, queries), found, found_distances, asked,
                    flann::SearchParams(static_cast<int>(options.checks)));
    for (std::uint32_t q = 0; q < queries; ++q) {
      const std::uint32_t p = first + q;
      std::vector<std::pair<std::uint32_t, std::uint32_t>> list;  // (distance, id)
      const auto add = [&](std::size_t id) {
        const auto other = static_cast<std::uint32_t>(id);
        const bool listed =
            std::ranges::any_of(list, [&](const auto& entry) { return entry.second == other; });
        if (id < count && other != p && !listed && list.size() < k)
          list.emplace_back(points.distance(p, other), other);
      };
      for (std::size_t i = 0; i < asked; ++i) add(ids[q * asked + i]);
      for (std::uint32_t step = 1; list.size() < k; ++step) add((std::size_t{p} + step) % count);
      std::ranges::sort(list);
      for (std::uint32_t i = 0; i < k; ++i) {
        lists.distances[std::size_t{p} * k + i] = list[i].first;
        lists.ids[std::size_t{p} * k + i] = list[i].second;
      }
    }
  });
  return lists;
}

Permutation order_by_flann_tour(const VisibilityMatrix& matrix, const FlannOptions& options,
                                const PolishOptions& polishing, unsigned threads) {
  const SparsePoints points(matrix);
  const VisibilityMatrix distinct = matrix_of(points);
  const ColumnPoints columns(distinct);
  const NeighbourLists lists = flann_neighbours(distinct, columns, options, threads);
  const Tour tour = polish(columns, lists, greedy_edge_tour(columns, lists), polishing);
  return points.order_of_columns(visits_of_tour(tour));
}

}  // namespace vismat
