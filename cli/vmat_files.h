// Matrix files and `.vmat` files alike, for the verbs that read either.
#pragma once
#include <filesystem>
#include <functional>
#include <string>

#include "codecs/container.h"
#include "matrix/dataset.h"

namespace vismat::cli {

/// The facts that Container keeps, a line each.
std::string facts_of(const Dataset& data);
/// Calls work with the container of the file; what goes wrong names the file.
void with_container(const std::filesystem::path& path, const std::function<void(const Container&)>& work);
/// The codec that the file names, unchecked: for who then opens it one way or another.
std::string codec_of(const std::filesystem::path& path);
/// All that a `.vmat` file holds, as it is stored. Throws as read_dataset does.
Dataset read_vmat(const std::filesystem::path& path);
/// `.vmat`, or what read_dataset reads; told apart by the first bytes.
Dataset read_any_matrix(const std::filesystem::path& path);

}  // namespace vismat::cli
