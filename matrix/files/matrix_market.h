// Reads and writes the Matrix Market exchange format (math.nist.gov/MatrixMarket/formats.html), which is plain text, 1-based.
#pragma once
#include <iosfwd>
#include <string_view>

#include "matrix/dataset.h"
#include "matrix/files/matrix_notes.h"

namespace vismat {

/// Whether the text begins as Matrix Market, in small letters or capitals.
bool is_matrix_market(std::string_view text);

/// Reads any matrix, `coordinate` or `array`: pattern, integer, unsigned-integer, real or complex (an entry whose value
/// is zero is not visible), general or with one triangle stored, whichever that is. Entries may come in any order and
/// several times, with any whitespace, LF, CR LF or CR, and comments and blank lines between; a DOS end-of-file mark
/// ends the text. Numbers may have Fortran's exponents. Comments `%%vismat key: value` give the facts that
/// write_matrix_market writes. `notes` tells what was not taken as it stands. Throws FormatError naming the line for
/// indices out of range, values that are no finite number, and more or fewer entries than announced. Takes 8 bytes for
/// each entry beyond the text and the matrix. O(entries); rows are sorted only if they are not sorted yet.
Dataset read_matrix_market(std::string_view text, MatrixNotes* notes = nullptr);

/// Writes a matrix `coordinate pattern general`, row by row, with the facts as comments. Geometry and tree are left
/// out, and so is the fact that columns are nodes. The caller checks the stream.
void write_matrix_market(std::ostream& out, const Dataset& dataset);

}  // namespace vismat
