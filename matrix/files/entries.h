// Makes a matrix of entries in any order, as coordinate files list them.
#pragma once
#include <cstdint>
#include <vector>

#include "matrix/visibility_matrix.h"

namespace vismat {

struct Entry {
  std::uint32_t row, column;
};

/// The matrix of these entries, which must lie within the shape; what is there several times is visible once, and
/// `repeated` grows by each further time. O(entries + rows); rows are sorted only if they are not sorted yet.
VisibilityMatrix matrix_of_entries(Shape shape, const std::vector<Entry>& entries, std::uint64_t& repeated);

/// The union of a square matrix with its transpose, as the structures mean that store one triangle.
VisibilityMatrix with_transpose(const VisibilityMatrix& half);

}  // namespace vismat
