// Reads matrix files and `.vmat` files for the verbs that take either.
#pragma once
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "codecs/vmat/container.h"
#include "matrix/dataset.h"
#include "matrix/files/dataset_file.h"

namespace vismat::cli {

/// The facts that Container keeps, one on each line.
std::string facts_of(const Dataset& data);
/// Calls `work` with the container of the file; an error names the file.
void with_container(const std::filesystem::path& path, const std::function<void(const Container&)>& work);
/// The bytes of a `.vmat` file, unpacked if it is gzipped. Throws FormatError if it is a matrix of another format.
std::vector<std::byte> bytes_of_vmat(const std::filesystem::path& path);
/// All that a `.vmat` file holds, in its stored order. `boxes` are for codecs that encode with them. Throws as read_dataset does.
Dataset read_vmat(const std::filesystem::path& path, const Side& boxes = {});
/// The same for a file of version 3 or of the present version.
Dataset read_vmat_of_any_version(const std::filesystem::path& path, const Side& boxes = {});
/// What read_dataset reads. Prints a line with the notes, if there are any.
Dataset read_matrix(const std::filesystem::path& name);
Dataset read_matrix(const MatrixFile& file);
/// write_dataset, and a line with what the file has no place for, if there is anything.
void write_matrix(const std::filesystem::path& path, const Dataset& data);
/// Reads a `.vmat` file, or whatever read_matrix reads; they are told apart by the first bytes.
Dataset read_any_matrix(const std::filesystem::path& name);

}  // namespace vismat::cli
