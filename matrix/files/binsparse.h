// Reads and writes Binsparse, the cross-platform binary sparse matrix format, in HDF5
// (graphblas.org/binsparse-specification, version 0.1). docs/files.md describes our layout in full.
#pragma once
#include "matrix/dataset.h"
#include "matrix/files/hdf5_file.h"
#include "matrix/files/matrix_notes.h"

namespace vismat {

/// Reads a matrix in any predefined matrix format of the specification (CSR, CSC, DCSR, DCSC, COO, COOR, COOC, DMAT,
/// DMATR, DMATC), with any integer index type, any values and any `structure`; the arrays lie in the group with which the
/// file was opened. An entry whose value is zero is not visible and is dropped, so `iso` of zero gives an empty matrix. Also reads our own
/// geometry and facts if they are there. Throws FormatError, without the file's name, for what the specification
/// forbids (indices out of range, unsorted or repeated), and for what cannot be a visibility matrix: vectors, custom
/// formats, a fill value other than zero. O(entries). Memory: the matrix and little more for CSR, twice that for the
/// column formats.
Dataset read_binsparse(const Hdf5File& file, MatrixNotes* notes = nullptr);

/// Writes the matrix as CSR with `iso[bint8]` values, the facts as attributes `vismat_...` of the root, and the rest as
/// arrays under /vismat.
void write_binsparse(Hdf5File& file, const Dataset& dataset);

}  // namespace vismat
