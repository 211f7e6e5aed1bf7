// Checks the names of the files that a verb will write, before it works for hours and then loses something.
#pragma once
#include <filesystem>
#include <span>
#include <string>

namespace vismat {

/// What is written: a matrix file, a scene file, a .vmat file, text (tables, JSON), or several files into a folder.
/// made_folder: a folder that is made if it is not there; any other must be.
enum class Written { matrix, scene, vmat, text, folder, made_folder };

struct OutputName {
  std::string option;  // by which the user gave it, for messages
  std::filesystem::path path;
  Written what = Written::text;
};

/// Throws std::invalid_argument or std::runtime_error, naming the output, if one
/// - ends as no file of its kind does (.bsp.h5, .h5, .hdf5 or .mtx; .scene.h5 or .h5; .vmat; text: anything else);
/// - cannot be written where it is: no such folder, no right to, HDF5 on a device;
/// - is the same file as an input or as another output, by whatever name. Devices may be named twice.
/// An input may be a part of a file, FILE:PART, and need not exist.
void check_outputs(std::span<const std::filesystem::path> inputs, std::span<const OutputName> outputs);

}  // namespace vismat
