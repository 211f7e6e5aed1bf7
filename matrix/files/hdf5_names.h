// Lists of names in HDF5 files: UTF-8, one after another, with a zero byte behind each.
#pragma once
#include <string>
#include <vector>

#include "matrix/files/hdf5_file.h"

namespace vismat {

/// Empty if there is no such array. Throws FormatError if the last name has no zero byte.
std::vector<std::string> read_names(const Hdf5File& file, const std::string& name);
/// Writes nothing for an empty list.
void write_names(Hdf5File& file, const std::string& name, const std::vector<std::string>& names);

}  // namespace vismat
