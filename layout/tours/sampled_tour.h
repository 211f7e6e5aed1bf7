// Paper 000's order of columns: nearest neighbours within random samples.
#pragma once
#include <cstdint>
#include <vector>

#include "matrix/base/parallel.h"
#include "matrix/permutation.h"
#include "matrix/visibility_matrix.h"

namespace vismat {

struct SampledTourOptions {
  std::uint32_t neighbours = 700;  // k: kept of each sample
  /// Columns sampled for each; 0: sample_size(columns, neighbours).
  std::uint32_t samples = 0;
  bool flip_edges = true;              // step 4
  std::uint32_t flip_neighbours = 10;  // looked at by step 4, of the k
  std::uint64_t seed = 1;
  Stages stages = {};
};

/// The paper's rule: k times c log(columns) / alpha, where c makes that 16 at 400,000 columns and alpha =
/// .25.
std::uint32_t sample_size(std::uint32_t columns, std::uint32_t neighbours);

/// [Chhugani et al. 2005, 6.1, steps 1-4]: from the first column, always to the nearest of its k that is not
/// yet visited, else to the first column not yet visited; then local edge flips (2-opt). Takes the columns as
/// they are, equal and empty ones too. Same seed, same order, for any thread count. Each distance is exact;
/// all of them take samples * ones additions. Memory: the matrix once more, 4 bytes for each of columns * k,
/// sketches for step 4. Breaks where a column's like are rarer than columns / samples: its sample then holds
/// none of them. Light columns are near to everything and fill the lists of all others; they are used up
/// early, and dummy edges follow. order_by_scale_tour finds what it misses, in less time.
Permutation order_by_sampled_tour(const VisibilityMatrix& matrix, const SampledTourOptions& options = {},
                                  unsigned threads = 0);

}  // namespace vismat
