// What the verbs about rows-small and rows-quick share.
#pragma once
#include <array>
#include <cstdint>
#include <string>

#include "codecs/modelled/modelled_rows.h"
#include "codecs/modelled/row_references.h"
#include "matrix/permutation.h"
#include "matrix/visibility_matrix.h"

namespace vismat::bench {

struct RowMatrix {
  std::string name;
  VisibilityMatrix matrix;
};

/// The level that a matrix is of: what stands before the first dot of its name.
inline std::string level_of(const RowMatrix& of) {
  return of.name.substr(0, of.name.find('.'));
}

struct RowTier {
  const char* codec;
  const RowLimits* limits;
};
inline constexpr std::array row_tiers = {RowTier{"rows-small", &small_limits},
                                         RowTier{"rows-quick", &quick_limits}};

inline VisibilityMatrix rows_ordered(const VisibilityMatrix& matrix, const Permutation& rows) {
  return permute(matrix, rows, Permutation::identity(matrix.shape().columns));
}

/// What the matrix takes in these codecs' own order of rows.
inline std::uint64_t bytes_within(const VisibilityMatrix& matrix, const RowLimits& limits) {
  return encode_modelled_rows(matrix, limits, {.rows_may_move = true}).bytes();
}

}  // namespace vismat::bench
