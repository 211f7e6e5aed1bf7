// Reads a dataset from a matrix file and writes it to one: Binsparse on HDF5, Matrix Market, or the files of NumPy and SciPy.
#pragma once
#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "matrix/dataset.h"
#include "matrix/files/matrix_notes.h"

namespace vismat {

/// A file that may hold a matrix, read once, so that it may be a pipe.
struct MatrixFile {
  std::filesystem::path path;
  std::string part;                    // behind FILE: a group of an HDF5 file, or the columns of packed bits
  bool is_hdf5 = false;                // then its library reads it
  bool gzipped = false;                // then `bytes` are unpacked
  std::vector<std::byte> bytes;        // empty for HDF5
  std::filesystem::path name() const;  // as the user named it
};
/// Reads FILE, or FILE of FILE:PART if there is no file FILE:PART. Throws FormatError or std::runtime_error, both naming
/// the file: for one that cannot be opened, a damaged gzip file, and HDF5 from a pipe.
MatrixFile open_matrix_file(const std::filesystem::path& name);
/// What the first bytes say that it is: "Binsparse on HDF5", "Matrix Market", "NumPy array", "SciPy or NumPy archive";
/// empty for everything else.
std::string_view format_of(const MatrixFile& file);

/// Reads `.bsp.h5`, `.h5`, `.hdf5` (Binsparse), `.mtx` (Matrix Market), `.npy` (NumPy) or `.npz` (SciPy, NumPy), which
/// are told apart by their first bytes; all but HDF5 may be gzipped. FILE.h5:GROUP names a group of an HDF5 file,
/// FILE.npy:COLUMNS says that the array holds bits, packed along each row. `notes` tells what was not taken as it
/// stands. Throws FormatError or std::runtime_error, both naming the file.
Dataset read_dataset(const std::filesystem::path& name, MatrixNotes* notes = nullptr);
Dataset read_dataset(const MatrixFile& file, MatrixNotes* notes = nullptr);
/// FILE of FILE.npy:COLUMNS; other names as they are.
std::filesystem::path matrix_file_of(const std::filesystem::path& name);
/// Throws std::invalid_argument unless the name ends in .h5, .hdf5, .mtx, .npy, .npz or .npy:COLUMNS.
void check_matrix_name(const std::filesystem::path& path);
/// Writes the format that the file name's ending names. `.mtx` keeps the matrix and, as comments, the facts, but not
/// the geometry; `.npy` and `.npz` keep the matrix alone; FILE.npy:COLUMNS packs its bits. Throws std::invalid_argument for
/// another ending, for other COLUMNS than the matrix has, or if the source map does not fit the matrix. The file appears
/// completely or not at all.
void write_dataset(const std::filesystem::path& path, const Dataset& dataset);
/// Whether the ending is one of HDF5, which has a place for all of a dataset.
bool keeps_everything(const std::filesystem::path& path);
/// What the dataset has and write_dataset leaves out of a file of this name: "boxes, trees"; empty if nothing.
std::string left_out_in(const std::filesystem::path& path, const Dataset& dataset);

}  // namespace vismat
