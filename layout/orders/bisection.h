// An order of columns by recursive graph bisection.
#pragma once
#include <cstdint>

#include "matrix/permutation.h"
#include "matrix/visibility_matrix.h"

namespace vismat {

struct BisectionOptions {
  std::uint32_t iterations = 20;  // at most this many rounds of swaps between two halves
  std::uint32_t smallest = 16;    // parts of at most this many columns stay as they are
};

/// Halves the columns again and again so that each row sees mostly one half, which makes the gaps between a row's ids
/// small [Dhulipala et al., Compressing graphs and indexes with recursive graph bisection, KDD 2016]. Begins with the
/// columns as they are. O(iterations * ones * log columns). It minimizes the logarithms of gaps, not the number of
/// runs: use it if ids are coded by gaps or a tour is too slow. docs/orders.md compares it with a polished tour.
Permutation order_by_bisection(const VisibilityMatrix& matrix, const BisectionOptions& options = {});

}  // namespace vismat
