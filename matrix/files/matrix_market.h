// Reads and writes the Matrix Market exchange format (math.nist.gov/MatrixMarket/formats.html), which is plain text, 1-based.
#pragma once
#include <cstddef>
#include <iosfwd>
#include <span>

#include "matrix/dataset.h"

namespace vismat {

/// Any coordinate matrix: pattern, integer, real or complex (an entry whose value is zero is not visible and
/// dropped), general or with one triangle stored. Entries in any order, any whitespace, CRLF, comments and
/// blank lines between. Comments `%%vismat key: value` give the facts that write_matrix_market writes. Throws
/// FormatError naming the line: indices out of range, entries that repeat, more or fewer than promised, dense
/// arrays. Takes 8 bytes an entry beyond the text and the matrix. O(entries), rows sorted only where they are
/// not yet.
Dataset read_matrix_market(std::span<const std::byte> text);

/// A pattern coordinate general matrix, row by row, facts as comments; geometry and tree are left out, and so
/// is that columns are nodes. The caller checks the stream.
void write_matrix_market(std::ostream& out, const Dataset& dataset);

}  // namespace vismat
