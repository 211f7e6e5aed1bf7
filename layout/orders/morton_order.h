// Objects as they lie in space.
#pragma once
#include <span>

#include "matrix/dataset.h"
#include "matrix/permutation.h"

namespace vismat {

/// Objects along a Z-order curve through the centres of their boxes [Morton 1966], 21 bits an axis over the common box; ties
/// by number. O(n log n), and needs no matrix. Knows nothing of who sees what: breaks where near objects are hidden from
/// one another, as in a building; use best_order wherever there is a matrix.
Permutation morton_order(std::span<const Box> bounds);

}  // namespace vismat
