// The matrix of a Binsparse file, in any format of the specification.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "matrix/files/hdf5_file.h"
#include "matrix/files/matrix_notes.h"
#include "matrix/visibility_matrix.h"

namespace vismat {

/// Reads the matrix that the arrays of the file's group hold and that their descriptor, a JSON text, describes. Throws
/// FormatError as read_binsparse does.
VisibilityMatrix read_binsparse_matrix(const Hdf5File& file, const std::string& descriptor,
                                       MatrixNotes* notes = nullptr);

/// Writes the matrix as CSR with `iso[bint8]` values, and its descriptor.
void write_binsparse_matrix(Hdf5File& file, const VisibilityMatrix& matrix);

/// Throws the FormatError "where: what".
[[noreturn]] void refuse_array(const std::string& where, const std::string& what);
/// Refuses an array whose length is not `wanted`; `why` says what requires that length.
void need_length(const std::string& name, std::uint64_t length, std::uint64_t wanted, const char* why);

/// Refuses offsets that do not ascend from 0 to `ids`.
void check_offsets(const std::vector<std::uint64_t>& offsets, std::uint64_t ids, const std::string& name);
/// Refuses ids that are not below `bound` or do not ascend within a line; `line_is` and `id_is` say in messages what
/// lines and ids are.
void check_ids(const std::vector<std::uint64_t>& offsets, const std::vector<std::uint32_t>& ids,
               std::uint32_t bound, const std::string& name, const std::string& line_is,
               const std::string& id_is);

}  // namespace vismat
