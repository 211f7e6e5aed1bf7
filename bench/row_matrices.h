// What the verbs about rows-small and rows-quick share: matrices, and their rows in the order that these codecs like.
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
  bool rows_move;  // differences stay in the order of their boundaries
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

/// Rows that may move are in the order of their references.
inline VisibilityMatrix in_own_order(const VisibilityMatrix& matrix, const RowLimits& limits,
                                     bool rows_move) {
  return rows_move ? rows_ordered(matrix, order_for_references(matrix, limits, 0)) : matrix;
}

/// What the matrix takes in that order.
inline std::uint64_t bytes_within(const VisibilityMatrix& matrix, const RowLimits& limits, bool rows_move) {
  return encode_modelled_rows(in_own_order(matrix, limits, rows_move), limits, 0).bytes();
}

}  // namespace vismat::bench
