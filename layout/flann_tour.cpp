#include "layout/flann_tour.h"

#include <algorithm>
#include <flann/flann.hpp>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "layout/distinct_columns.h"
#include "matrix/bit_rows.h"
#include "matrix/parallel.h"

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
