// rows-small and rows-quick: each row is coded under a similar one and that one's own reference, with probabilities that
// are the same for all files. Any row is read alone: the chain of rows that it takes is bounded by the encoder.
#pragma once
#include <cstdint>
#include <vector>

#include "codecs/codec.h"
#include "codecs/modelled/row_model.h"

namespace vismat {

/// How far an encoder may go. The format is the same for all limits.
struct RowLimits {
  double microseconds;  // of decoding any row, modelled
  double mean_rows;     // the same, as a multiple of the mean row's, where rows stay in their order
  std::uint32_t group;  // rows in a part, at most ModelledRowFormat::largest_group
  std::uint32_t kept;   // rows that readers decode at once and keep, at most
  bool names_second = true, names_runs = true;  // rows may name second references, and common runs
  const RowWeights* weights = &row_weights;     // only training has others
};
inline constexpr RowLimits small_limits{55, 38, 16, 255};
inline constexpr RowLimits quick_limits{17.3, 11.2, 8, 255};

struct ModelledRowFormat {
  static constexpr std::uint32_t largest_group = 16;  // rows in a part
  static constexpr std::uint32_t most_kept = 255;
  static constexpr std::uint32_t longest_chain = 256;  // parts that a row may take
  static constexpr std::uint32_t longest_way = 255;    // rows back to a second reference
  static constexpr std::uint32_t steps = 8;  // groups that a group is looked for under, before any is named
  /// Fewer rows than this need no bytes that back them.
  static constexpr std::uint64_t free_rows = std::uint64_t{1} << 22;
};

/// The rows within the limits; smallest if they may move. Uses threads, rows_may_move and progress.
Encoded encode_modelled_rows(const VisibilityMatrix& matrix, const RowLimits& limits,
                             const EncodeOptions& options);

/// rows-small and rows-quick.
std::vector<Codec> modelled_codecs();

}  // namespace vismat
