// ALGORITHM [Chhugani et al. 2005, section 6.1]. The paper's tour, with two liberties.
// - Columns in blocks of samples / 8 share a sample: one sample for all would leave every other column unlisted, one
//   for each is too expensive. A block's exact distances then come from an inverted index of its sample: each one
//   of a column adds 1 to the sampled columns with a one in that row, and |a xor b| = |a| + |b| - 2 |a and b|.
// - Step 4 does not say which edges are flipped: here it is 2-opt, with the new edge within the nearest few of a list.
#include "layout/tours/sampled_tour.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>

#include "layout/orders/random_order.h"
#include "layout/tours/sparse_search.h"
#include "layout/tours/tour.h"
#include "matrix/base/parallel.h"
#include "matrix/base/random.h"

namespace vismat {
namespace {

constexpr std::uint32_t most_samples = 65535;  // a sampled column's number within its block has 16 bits

// `count` different columns, ascending.
std::vector<std::uint32_t> sample_of(std::uint32_t columns, std::uint32_t count, Random random) {
  std::vector<std::uint32_t> sample = random_sample(columns, count, random);
  std::sort(sample.begin(), sample.end());
  return sample;
}

// Which of a sample's columns have a one in a row.
class SampleIndex {
 public:
  SampleIndex(const SparsePoints& points, const std::vector<std::uint32_t>& sample)
      : first_(std::size_t{points.rows()} + 2, 0) {
    for (const std::uint32_t s : sample) {
      for (const std::uint32_t row : points.ones(s)) ++first_[row + 2];
    }
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    members_.resize(first_.back());
    for (std::size_t i = 0; i < sample.size(); ++i) {
      for (const std::uint32_t row : points.ones(sample[i]))
        members_[first_[row + 1]++] = static_cast<std::uint16_t>(i);
    }
  }
  void count_shared(std::span<const std::uint32_t> rows, std::vector<std::uint32_t>& shared) const {
    for (const std::uint32_t row : rows) {
      for (std::uint64_t i = first_[row]; i < first_[row + 1]; ++i) ++shared[members_[i]];
    }
  }

 private:
  std::vector<std::uint64_t> first_;  // of a row; one place further while the members are filled in
  std::vector<std::uint16_t> members_;
};

struct SampledLists {
  std::uint32_t per_point;
  std::vector<std::uint32_t> ids;  // nearest first
  NeighbourLists nearest;          // the first few, with distances
};

SampledLists sampled_neighbours(const SparsePoints& points, const SampledTourOptions& options,
                                std::uint32_t samples, unsigned threads) {
  const std::uint32_t count = points.size(), k = std::min(options.neighbours, samples);
  SampledLists lists{k, std::vector<std::uint32_t>(std::size_t{count} * k, no_point), {}};
  const std::uint32_t few = lists.nearest.per_point =
      options.flip_edges ? std::min(k, options.flip_neighbours) : 0;
  lists.nearest.ids.assign(std::size_t{count} * few, no_point);
  lists.nearest.distances.assign(std::size_t{count} * few, no_point);
  const std::uint32_t block = std::max(16u, samples / 8);
  const auto list_block = [&](std::uint64_t b) {
    const auto sample = sample_of(count, samples, Random(options.seed, b));
    const SampleIndex index(points, sample);
    std::vector<std::uint32_t> shared(sample.size());
    std::vector<std::uint64_t> keys;  // distance, then place in the sample
    const auto end = static_cast<std::uint32_t>(std::min<std::uint64_t>(count, (b + 1) * block));
    for (auto p = static_cast<std::uint32_t>(b * block); p < end; ++p) {
      std::fill(shared.begin(), shared.end(), 0);
      index.count_shared(points.ones(p), shared);
      keys.clear();
      for (std::uint32_t i = 0; i < sample.size(); ++i) {
        if (sample[i] == p) continue;
        const std::uint64_t distance =
            points.weight(p) + std::uint64_t{points.weight(sample[i])} - 2 * shared[i];
        keys.push_back(distance << 16 | i);
      }
      if (keys.size() > k) {
        std::nth_element(keys.begin(), keys.begin() + k, keys.end());
        keys.resize(k);
      }
      std::sort(keys.begin(), keys.end());
      for (std::size_t i = 0; i < keys.size(); ++i)
        lists.ids[std::size_t{p} * k + i] = sample[keys[i] & 0xffff];
      for (std::size_t i = 0; i < std::min<std::size_t>(few, keys.size()); ++i) {
        lists.nearest.ids[std::size_t{p} * few + i] = sample[keys[i] & 0xffff];
        lists.nearest.distances[std::size_t{p} * few + i] = static_cast<std::uint32_t>(keys[i] >> 16);
      }
    }
  };
  parallel_for((std::uint64_t{count} + block - 1) / block, threads, list_block,
               begin_stage(options.stages, "nearest of the samples"));
  return lists;
}

std::vector<std::uint32_t> walk(std::uint32_t count, const SampledLists& lists) {
  std::vector<std::uint32_t> tour;
  std::vector<bool> visited(count, false);
  for (std::uint32_t at = 0, first_free = 0; tour.size() < count;) {
    tour.push_back(at);
    visited[at] = true;
    const auto begin = lists.ids.begin() + static_cast<std::ptrdiff_t>(std::size_t{at} * lists.per_point);
    const auto end = begin + lists.per_point;
    const auto free = std::find_if(begin, end, [&](std::uint32_t p) { return p != no_point && !visited[p]; });
    while (first_free < count && visited[first_free]) ++first_free;
    at = free != end ? *free : first_free;
  }
  return tour;
}

}  // namespace

std::uint32_t sample_size(std::uint32_t columns, std::uint32_t neighbours) {
  const double for_one = 16 * std::log(std::max(2., static_cast<double>(columns))) / std::log(400000.);
  return static_cast<std::uint32_t>(std::min<double>(most_samples, std::round(neighbours * for_one)));
}

Permutation order_by_sampled_tour(const VisibilityMatrix& matrix, const SampledTourOptions& options,
                                  unsigned threads) {
  if (options.neighbours == 0)
    throw std::invalid_argument("a sampled tour keeps at least 1 neighbour of each column");
  if (options.samples > most_samples)
    throw std::invalid_argument("a sampled tour samples at most " + std::to_string(most_samples) +
                                " columns for each");
  const std::uint32_t count = matrix.shape().columns;
  const std::uint32_t rule = options.samples != 0 ? options.samples : sample_size(count, options.neighbours);
  const std::uint32_t samples = std::min(rule, count);
  const SparsePoints points(matrix, false);
  SampledLists lists = sampled_neighbours(points, options, samples, threads);
  std::vector<std::uint32_t> tour = walk(count, lists);
  if (options.flip_edges) {
    lists.ids = {};
    tour.push_back(points.zero());
    tour = visits_of_tour(improve_tour(points, ColumnSketches(points, 0, threads), lists.nearest,
                                       std::move(tour), {.three_opt = false, .longest_flip = count}));
  }
  return points.order_of_columns(tour);
}

}  // namespace vismat
