// The table of orders of columns: tests, benchmarks and the program loop over it. Rows are ordered as the columns of
// the transposed matrix.
#pragma once
#include <cstdint>
#include <span>
#include <string_view>

#include "matrix/base/parallel.h"
#include "matrix/dataset.h"
#include "matrix/permutation.h"
#include "matrix/visibility_matrix.h"

namespace vismat {

struct ReorderingOptions {
  std::uint64_t seed = 1;
  std::span<const Box> column_bounds;  // for morton
  /// If above 0, methods that can continue for ever do so for that long, and the order depends on the machine's speed.
  double seconds = 0;
  unsigned threads = 0;  // 0: one for each core; the order does not depend on it
  Stages stages = {};
};

/// An order as a plain value. `order_columns` throws std::invalid_argument if it lacks what it needs.
struct Reordering {
  std::string_view name;
  std::string_view idea;
  Permutation (*order_columns)(const VisibilityMatrix&, const ReorderingOptions&);
};

std::span<const Reordering> reorderings();
const Reordering& find_reordering(
    std::string_view name);  // throws std::invalid_argument that lists the names

}  // namespace vismat
