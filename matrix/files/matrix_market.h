// Reads and writes the Matrix Market exchange format (math.nist.gov/MatrixMarket/formats.html), which is plain text, 1-based.
#pragma once
#include <cstddef>
#include <iosfwd>
#include <span>

#include "matrix/dataset.h"

namespace vismat {

/// Reads any coordinate matrix: pattern, integer, real or complex (an entry whose value is zero is not visible and is
/// dropped), general or with one triangle stored. Entries may come in any order, with any whitespace, CRLF, and
/// comments and blank lines between. Comments `%%vismat key: value` give the facts that write_matrix_market writes.
/// Throws FormatError naming the line for indices out of range, repeated entries, more or fewer entries than announced,
/// and dense arrays. Takes 8 bytes for each entry beyond the text and the matrix. O(entries); rows are sorted only if
/// they are not sorted yet.
Dataset read_matrix_market(std::span<const std::byte> text);

/// Writes a matrix `coordinate pattern general`, row by row, with the facts as comments. Geometry and tree are left
/// out, and so is the fact that columns are nodes. The caller checks the stream.
void write_matrix_market(std::ostream& out, const Dataset& dataset);

}  // namespace vismat
