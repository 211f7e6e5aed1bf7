// Reads a dataset from a matrix file and writes it to one: Binsparse on HDF5, or Matrix Market.
#pragma once
#include <filesystem>

#include "matrix/dataset.h"

namespace vismat {

/// Reads `.bsp.h5`, `.h5`, `.hdf5` (Binsparse) or `.mtx` (Matrix Market), which are told apart by their first bytes.
/// Throws FormatError or std::runtime_error, both naming the file.
Dataset read_dataset(const std::filesystem::path& path);
/// Throws std::invalid_argument unless the name ends in .h5, .hdf5 or .mtx.
void check_matrix_name(const std::filesystem::path& path);
/// Writes the format that the file name's ending names; `.mtx` keeps the matrix and, as comments, the facts, but not
/// the geometry. Throws std::invalid_argument for another ending, or if the source map does not fit the matrix. The
/// file appears completely or not at all.
void write_dataset(const std::filesystem::path& path, const Dataset& dataset);

}  // namespace vismat
