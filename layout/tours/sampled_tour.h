// The order of columns of Chhugani et al. 2005: nearest neighbours within random samples.
#pragma once
#include <cstdint>
#include <vector>

#include "matrix/base/parallel.h"
#include "matrix/permutation.h"
#include "matrix/visibility_matrix.h"

namespace vismat {

struct SampledTourOptions {
  std::uint32_t neighbours = 700;  // k: kept of each sample
  /// The number of columns sampled for each column; 0: sample_size(columns, neighbours).
  std::uint32_t samples = 0;
  bool flip_edges = true;              // step 4
  std::uint32_t flip_neighbours = 10;  // the neighbours of the k that step 4 examines
  std::uint64_t seed = 1;
  Stages stages = {};
};

/// The paper's rule: k times c log(columns) / alpha, with alpha = 0.25 and c chosen so that the sample size is 16 k for
/// 400,000 columns.
std::uint32_t sample_size(std::uint32_t columns, std::uint32_t neighbours);

/// Steps 1 to 4 of the paper's method [Chhugani et al. 2005, section 6.1]: from the first column, always to the nearest
/// of its k neighbours that is not yet visited, otherwise to the first column not yet visited; then local edge flips
/// (2-opt). Takes the columns as they are, equal and empty ones too. The same seed gives the same order with any number
/// of threads. Each distance is exact; together they take samples * ones additions. Memory: the matrix once more, 4
/// bytes for each of columns * k, and sketches for step 4. Fails if the columns similar to a column are rarer than
/// columns / samples: its sample then has none of them. Columns with few ones are near to every column and fill the
/// lists of all others; they are used up early, and afterwards the next column in natural order is taken.
/// order_by_scale_tour finds what this misses, in less time.
Permutation order_by_sampled_tour(const VisibilityMatrix& matrix, const SampledTourOptions& options = {},
                                  unsigned threads = 0);

}  // namespace vismat
