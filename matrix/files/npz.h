// Reads and writes .npz, a zip archive of .npy members, as scipy.sparse.save_npz writes it.
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "matrix/files/matrix_notes.h"
#include "matrix/visibility_matrix.h"

namespace vismat {

/// Whether this is a zip archive with a member that ends in .npy.
bool is_npz(std::span<const std::byte> file);
/// Reads a sparse matrix that scipy.sparse.save_npz wrote (csr, csc, coo, bsr, dia), or the only array of what
/// numpy.savez wrote. Stored zeros are not visible; an entry may be listed several times. Throws FormatError, also at
/// members that together unpack to more than `most` bytes.
VisibilityMatrix read_npz(std::span<const std::byte> file, std::uint64_t most, MatrixNotes* notes = nullptr);
/// An archive that scipy.sparse.load_npz reads as a csr matrix of booleans. The same matrix gives the same bytes.
std::vector<std::byte> npz_of(const VisibilityMatrix& matrix);

}  // namespace vismat
