// Which rows are near each row: where an encoder looks for the row under which to code it.
#pragma once
#include <cstdint>
#include <vector>

#include "codecs/modelled/row_bits.h"
#include "matrix/visibility_matrix.h"

namespace vismat {

/// For each row the numbers of up to `count` other rows, the most promising reference first: those with the least
/// 4 l + m, where l run ends of the row are not the reference's, and m the other way round. Of at most some thousands of
/// rows all are compared, O(rows^2 columns / 64); else those whose min-hashes are near. Of equally good
/// ones the one with the least name is first. The same lists for any number of threads.
std::vector<std::vector<std::uint32_t>> near_rows(const VisibilityMatrix& matrix, const RowEnds& ends,
                                                  const std::vector<std::uint64_t>& names,
                                                  std::uint32_t count, unsigned threads);

/// 4 l + m, as above.
std::uint32_t reference_distance(Ends reference, Ends row);

}  // namespace vismat
