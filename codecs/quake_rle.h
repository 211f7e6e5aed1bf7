// Quake's run lengths of zero bytes, row by row (Quake, Quake 2, Source).
#pragma once
#include <cstddef>
#include <span>
#include <vector>

#include "matrix/visibility_matrix.h"

namespace vismat {

/// Each byte of the bitmap's row as it is, but a run of 1 to 255 zero bytes as 0 and the run's length; runs
/// end with their row.
std::vector<std::byte> quake_rle_bytes(const VisibilityMatrix& matrix);
/// Throws FormatError on a run of 0 bytes, a run past its row's end, too few or too many bytes.
VisibilityMatrix matrix_from_quake_rle(std::span<const std::byte> bytes, Shape shape);

}  // namespace vismat
