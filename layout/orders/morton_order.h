// An order of objects by their places in space.
#pragma once
#include <span>

#include "matrix/dataset.h"
#include "matrix/permutation.h"

namespace vismat {

/// Objects along a Z-order curve through the centres of their boxes [Morton 1966], 21 bits for each axis over the
/// common box; ties by number. O(n log n); needs no matrix. It does not know who sees what, so it fails if near objects
/// are hidden from one another, as in a building; use best_order if there is a matrix.
Permutation morton_order(std::span<const Box> bounds);

}  // namespace vismat
