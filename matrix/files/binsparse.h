// Reads and writes Binsparse, the cross-platform binary sparse matrix format, in HDF5
// (graphblas.org/binsparse-specification, version 0.1). docs/files.md describes our layout in full.
#pragma once
#include "matrix/dataset.h"
#include "matrix/files/hdf5_file.h"

namespace vismat {

/// A matrix in any predefined matrix format of the specification (CSR, CSC, DCSR, DCSC, COO, COOR, COOC,
/// DMAT, DMATR, DMATC), with any integer index type, any values and any `structure`; the datasets lie in the
/// root group. An entry whose value is zero is not visible and dropped, so `iso` of zero gives an empty
/// matrix. Our own geometry and facts where they are there. Throws FormatError, without the file's name, for
/// what the specification forbids (indices out of range, unsorted or repeated), and for what cannot be a
/// visibility matrix: vectors, custom formats, a fill value other than zero. O(entries); memory: the matrix
/// and little more for CSR, twice that for the column formats.
Dataset read_binsparse(const Hdf5File& file);

/// CSR with `iso[bint8]` values; the facts as attributes `vismat_...` of the root, the rest as arrays under
/// /vismat.
void write_binsparse(Hdf5File& file, const Dataset& dataset);

}  // namespace vismat
